//! Encodes poses as VRPN messages.

use glam::DQuat;

use crate::pose::HeadPose;
use crate::vrpn::messages::Message;

/// The interval of a reported rotation, in seconds; shorter for rotations so fast that they would exceed half a
/// revolution, which a quaternion cannot represent.
const TURN_OVER_S: f64 = 0.1;
const LONGEST_TURN_RAD: f64 = 1.5;

/// Returns the messages for the pose and, if it has one, its velocity.
pub fn pose_reports(pose: &HeadPose) -> Vec<Message> {
    let sensor = pose.sensor;
    let mut reports = vec![Message::Pose {
        sensor,
        position_m: pose.placement.position_m,
        quat: pose.placement.orientation,
    }];
    if let Some(velocity) = pose.velocity {
        let speed = velocity.angular_rad_s.length();
        let dt_s = TURN_OVER_S.min(LONGEST_TURN_RAD / speed.max(1.0e-9));
        reports.push(Message::Velocity {
            sensor,
            linear: velocity.linear_m_s,
            quat: DQuat::from_scaled_axis(velocity.angular_rad_s * dt_s),
            dt_s,
        });
    }
    reports
}
