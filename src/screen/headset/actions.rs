//! Controllers through OpenXR: actions with suggested bindings for the common controllers and for
//! bare hands, their poses, and haptics. Returns [`HandsState`]; knows no tools.

use glam::{Quat, Vec2, Vec3};
use openxr as xr;

use super::error::{Doing, Result};
use crate::input::hands::{HandSide, HandState, HandsState};
use crate::view::RoomPose;

/// Longest vibration without renewal, in nanoseconds.
const PULSE_NS: i64 = 60_000_000;

/// Input paths of a controller for the actions; empty text for a missing one.
struct InteractionProfile {
    name: &'static str,
    trigger: &'static str,
    squeeze: &'static str,
    stick: &'static str,
    /// For the left and the right hand.
    menu: [&'static [&'static str]; 2],
    /// For the left and the right hand.
    pick: [&'static str; 2],
    haptic: bool,
    /// Needs XR_EXT_hand_interaction.
    bare_hands: bool,
}

const PROFILES: &[InteractionProfile] = &[
    InteractionProfile {
        name: "khr/simple_controller",
        trigger: "select/click",
        squeeze: "",
        stick: "",
        menu: [&["menu/click"], &["menu/click"]],
        pick: ["", ""],
        haptic: true,
        bare_hands: false,
    },
    InteractionProfile {
        name: "oculus/touch_controller",
        trigger: "trigger/value",
        squeeze: "squeeze/value",
        stick: "thumbstick",
        // The menu button of the right hand belongs to the system.
        menu: [&["menu/click", "y/click"], &["b/click"]],
        pick: ["x/click", "a/click"],
        haptic: true,
        bare_hands: false,
    },
    InteractionProfile {
        name: "valve/index_controller",
        trigger: "trigger/value",
        squeeze: "squeeze/value",
        stick: "thumbstick",
        menu: [&["b/click"], &["b/click"]],
        pick: ["a/click", "a/click"],
        haptic: true,
        bare_hands: false,
    },
    InteractionProfile {
        name: "microsoft/motion_controller",
        trigger: "trigger/value",
        squeeze: "squeeze/click",
        stick: "thumbstick",
        menu: [&["menu/click"], &["menu/click"]],
        pick: ["thumbstick/click", "thumbstick/click"],
        haptic: true,
        bare_hands: false,
    },
    InteractionProfile {
        name: "htc/vive_controller",
        trigger: "trigger/value",
        squeeze: "squeeze/click",
        stick: "trackpad",
        menu: [&["menu/click"], &["menu/click"]],
        pick: ["trackpad/click", "trackpad/click"],
        haptic: true,
        bare_hands: false,
    },
    InteractionProfile {
        name: "ext/hand_interaction_ext",
        trigger: "pinch_ext/value",
        squeeze: "grasp_ext/value",
        stick: "",
        menu: [&[], &[]],
        pick: ["", ""],
        haptic: false,
        bare_hands: true,
    },
];

/// The actions and the spaces of the hands.
pub(super) struct Actions {
    // Spaces are dropped before the actions that they are made from.
    grips: [xr::Space; 2],
    aims: [xr::Space; 2],
    grip: xr::Action<xr::Posef>,
    aim: xr::Action<xr::Posef>,
    trigger: xr::Action<f32>,
    squeeze: xr::Action<f32>,
    stick: xr::Action<xr::Vector2f>,
    menu: xr::Action<bool>,
    pick: xr::Action<bool>,
    haptic: xr::Action<xr::Haptic>,
    hands: [xr::Path; 2],
    /// The present strength of each hand's vibration.
    vibration: [f32; 2],
    session: xr::Session<xr::Vulkan>,
    set: xr::ActionSet,
}

impl Actions {
    /// Creates the actions and attaches them to the session, once.
    pub fn new(session: &xr::Session<xr::Vulkan>, has_hand_interaction: bool) -> Result<Actions> {
        const DOING: &str = "set up the controllers";
        let instance = session.instance();
        let path = |text: &str| instance.string_to_path(text).doing(DOING);
        let hands = [path("/user/hand/left")?, path("/user/hand/right")?];
        let set = instance.create_action_set("sculpting", "Sculpting", 0).doing(DOING)?;
        let grip = set.create_action("grip_pose", "Hand", &hands).doing(DOING)?;
        let aim = set.create_action("aim_pose", "Pointing", &hands).doing(DOING)?;
        let trigger = set.create_action("trigger", "Use the tool, click", &hands).doing(DOING)?;
        let squeeze = set.create_action("squeeze", "Grab the sculpture", &hands).doing(DOING)?;
        let stick = set
            .create_action("stick", "Resize the tool, undo and redo, scroll", &hands)
            .doing(DOING)?;
        let menu = set.create_action("menu", "Open the panel", &hands).doing(DOING)?;
        let pick = set.create_action("pick", "Pick a colour", &hands).doing(DOING)?;
        let haptic = set.create_action("haptic", "Haptic feedback", &hands).doing(DOING)?;

        for profile in PROFILES.iter().filter(|p| has_hand_interaction || !p.bare_hands) {
            let mut bindings = Vec::new();
            let buttons = profile.menu.into_iter().zip(profile.pick);
            for (hand, (menus, picks)) in ["left", "right"].into_iter().zip(buttons) {
                let input = |name: &str| path(&format!("/user/hand/{hand}/input/{name}"));
                bindings.push(xr::Binding::new(&grip, input("grip/pose")?));
                bindings.push(xr::Binding::new(&aim, input("aim/pose")?));
                if !profile.trigger.is_empty() {
                    bindings.push(xr::Binding::new(&trigger, input(profile.trigger)?));
                }
                if !profile.squeeze.is_empty() {
                    bindings.push(xr::Binding::new(&squeeze, input(profile.squeeze)?));
                }
                if !profile.stick.is_empty() {
                    bindings.push(xr::Binding::new(&stick, input(profile.stick)?));
                }
                for name in menus {
                    bindings.push(xr::Binding::new(&menu, input(name)?));
                }
                if !picks.is_empty() {
                    bindings.push(xr::Binding::new(&pick, input(picks)?));
                }
                if profile.haptic {
                    let output = path(&format!("/user/hand/{hand}/output/haptic"))?;
                    bindings.push(xr::Binding::new(&haptic, output));
                }
            }
            let name = path(&format!("/interaction_profiles/{}", profile.name))?;
            // A runtime may know only some controllers; the others are not needed then.
            if let Err(error) = instance.suggest_interaction_profile_bindings(name, &bindings) {
                tracing::debug!(
                    "no bindings for controllers of the kind {}: {error}",
                    profile.name
                );
            }
        }
        session.attach_action_sets(&[&set]).doing(DOING)?;
        let space = |action: &xr::Action<xr::Posef>, hand| {
            action.create_space(session, hand, xr::Posef::IDENTITY).doing(DOING)
        };
        Ok(Actions {
            grips: [space(&grip, hands[0])?, space(&grip, hands[1])?],
            aims: [space(&aim, hands[0])?, space(&aim, hands[1])?],
            grip,
            aim,
            trigger,
            squeeze,
            stick,
            menu,
            pick,
            haptic,
            hands,
            vibration: [0.0; 2],
            session: session.clone(),
            set,
        })
    }

    /// Returns the predicted state of both hands at `time`, in the space `room`.
    pub fn read(&self, room: &xr::Space, time: xr::Time) -> Result<HandsState> {
        const DOING: &str = "read the controllers";
        self.session.sync_actions(&[(&self.set).into()]).doing(DOING)?;
        let mut state =
            HandsState { time_s: time.as_nanos() as f64 * 1e-9, ..HandsState::default() };
        for side in HandSide::ALL {
            let (session, i) = (&self.session, side.index());
            let hand = self.hands[i];
            let pose = |action: &xr::Action<xr::Posef>, space: &xr::Space| -> Result<_> {
                match action.is_active(session, hand).doing(DOING)? {
                    true => Ok(valid_pose(space.locate(room, time).doing(DOING)?)),
                    false => Ok(None),
                }
            };
            let axis = |action: &xr::Action<f32>| -> Result<f32> {
                let state = action.state(session, hand).doing(DOING)?;
                Ok(if state.is_active { state.current_state } else { 0.0 })
            };
            let stick = self.stick.state(session, hand).doing(DOING)?;
            let is_down = |action: &xr::Action<bool>| -> Result<bool> {
                let state = action.state(session, hand).doing(DOING)?;
                Ok(state.is_active && state.current_state)
            };
            state.hands[i] = HandState {
                grip: pose(&self.grip, &self.grips[i])?,
                aim: pose(&self.aim, &self.aims[i])?,
                trigger: axis(&self.trigger)?,
                squeeze: axis(&self.squeeze)?,
                stick: match stick.is_active {
                    true => Vec2::new(stick.current_state.x, stick.current_state.y),
                    false => Vec2::ZERO,
                },
                menu: is_down(&self.menu)?,
                pick: is_down(&self.pick)?,
            };
        }
        Ok(state)
    }

    /// Vibrates a controller with a strength of 0 to 1. The vibration ends after [`PULSE_NS`] unless it
    /// is renewed.
    pub fn vibrate(&mut self, side: HandSide, strength: f32) -> Result<()> {
        const DOING: &str = "vibrate a controller";
        let hand = self.hands[side.index()];
        let before = std::mem::replace(&mut self.vibration[side.index()], strength);
        if strength > 0.0 {
            let pulse = xr::HapticVibration::new()
                .amplitude(strength.min(1.0))
                .frequency(xr::FREQUENCY_UNSPECIFIED)
                .duration(xr::Duration::from_nanos(PULSE_NS));
            self.haptic.apply_feedback(&self.session, hand, &pulse).doing(DOING)?;
            tracing::debug!("{side:?} hand vibrates: {strength:.2}");
        } else if before > 0.0 {
            self.haptic.stop_feedback(&self.session, hand).doing(DOING)?;
        }
        Ok(())
    }

    /// Returns the interaction profile of a hand, for the log.
    pub fn profile(&self, side: HandSide) -> Option<String> {
        let path = self.session.current_interaction_profile(self.hands[side.index()]).ok()?;
        if path == xr::Path::NULL {
            return None;
        }
        let name = self.session.instance().path_to_string(path).ok()?;
        Some(name.trim_start_matches("/interaction_profiles/").to_string())
    }
}

/// Returns the pose, if the runtime knows it and it is plausible.
fn valid_pose(location: xr::SpaceLocation) -> Option<RoomPose> {
    use xr::SpaceLocationFlags as Flags;
    let valid = Flags::ORIENTATION_VALID | Flags::POSITION_VALID;
    location
        .location_flags
        .contains(valid)
        .then(|| from_xr(&location.pose))
        .filter(RoomPose::is_plausible)
}

pub(super) fn from_xr(pose: &xr::Posef) -> RoomPose {
    let (q, p) = (pose.orientation, pose.position);
    RoomPose {
        position: Vec3::new(p.x, p.y, p.z),
        rotation: Quat::from_xyzw(q.x, q.y, q.z, q.w).normalize(),
    }
}

pub(super) fn to_xr(pose: &RoomPose) -> xr::Posef {
    let (q, p) = (pose.rotation, pose.position);
    xr::Posef {
        orientation: xr::Quaternionf { x: q.x, y: q.y, z: q.z, w: q.w },
        position: xr::Vector3f { x: p.x, y: p.y, z: p.z },
    }
}
