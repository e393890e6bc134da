//! Simulates that the headset is taken off and put on again, while the runtime itself notices nothing: the program
//! gets STOPPING, ends the session, gets IDLE, and READY when the headset is put on. Waiting for a frame in between is
//! an error, as the specification requires.

use std::collections::VecDeque;
use std::ffi::CStr;
use std::mem::transmute;
use std::path::Path;
use std::sync::Mutex;

use openxr_sys as xr;
use xr::pfn;

use crate::next;

/// The functions of the next layer, or of the runtime.
#[derive(Clone, Copy)]
pub struct Calls {
    poll_event: pfn::PollEvent,
    begin_session: pfn::BeginSession,
    end_session: pfn::EndSession,
    wait_frame: pfn::WaitFrame,
}

impl Calls {
    pub fn find(function: &dyn Fn(&CStr) -> Option<pfn::VoidFunction>) -> Option<Calls> {
        // SAFETY: the names say which types the functions have.
        unsafe {
            Some(Calls {
                poll_event: transmute::<pfn::VoidFunction, pfn::PollEvent>(function(
                    c"xrPollEvent",
                )?),
                begin_session: transmute::<pfn::VoidFunction, pfn::BeginSession>(function(
                    c"xrBeginSession",
                )?),
                end_session: transmute::<pfn::VoidFunction, pfn::EndSession>(function(
                    c"xrEndSession",
                )?),
                wait_frame: transmute::<pfn::VoidFunction, pfn::WaitFrame>(function(
                    c"xrWaitFrame",
                )?),
            })
        }
    }
}

/// The session as the program sees it.
struct SimulatedSession {
    session: xr::Session,
    /// Between begin and end.
    running: bool,
    /// The program has been told to stop.
    stopping: bool,
    /// States to report to the program.
    states: VecDeque<xr::SessionState>,
}

static SESSION: Mutex<Option<SimulatedSession>> = Mutex::new(None);

fn is_off() -> bool {
    std::env::var_os("VS_LAYER_OFF").is_some_and(|path| Path::new(&path).exists())
}

/// The layer's replacement for the function with this name, if it has one.
pub fn own(name: &[u8]) -> Option<pfn::VoidFunction> {
    std::env::var_os("VS_LAYER_OFF")?;
    // SAFETY: the caller knows by the name which type the function has.
    unsafe {
        match name {
            b"xrPollEvent" => Some(transmute::<pfn::PollEvent, pfn::VoidFunction>(poll_event)),
            b"xrBeginSession" => {
                Some(transmute::<pfn::BeginSession, pfn::VoidFunction>(begin_session))
            }
            b"xrEndSession" => Some(transmute::<pfn::EndSession, pfn::VoidFunction>(end_session)),
            b"xrWaitFrame" => Some(transmute::<pfn::WaitFrame, pfn::VoidFunction>(wait_frame)),
            _ => None,
        }
    }
}

unsafe extern "system" fn poll_event(
    instance: xr::Instance,
    event: *mut xr::EventDataBuffer,
) -> xr::Result {
    let Some(next) = next() else { return xr::Result::ERROR_RUNTIME_FAILURE };
    if let Ok(mut simulated) = SESSION.lock()
        && let Some(simulated) = &mut *simulated
    {
        use xr::SessionState as State;
        if is_off() && simulated.running && !simulated.stopping {
            simulated.stopping = true;
            simulated.states.extend([State::VISIBLE, State::SYNCHRONIZED, State::STOPPING]);
        } else if !is_off() && !simulated.running && simulated.stopping {
            simulated.stopping = false;
            simulated.states.push_back(State::READY);
        }
        if let Some(state) = simulated.states.pop_front() {
            let changed = xr::EventDataSessionStateChanged {
                ty: xr::EventDataSessionStateChanged::TYPE,
                next: std::ptr::null(),
                session: simulated.session,
                state,
                time: xr::Time::from_nanos(1),
            };
            // SAFETY: the caller gives room for any event.
            unsafe { event.cast::<xr::EventDataSessionStateChanged>().write(changed) };
            return xr::Result::SUCCESS;
        }
    }
    // SAFETY: passed on as it came.
    unsafe { (next.session.poll_event)(instance, event) }
}

unsafe extern "system" fn begin_session(
    session: xr::Session,
    info: *const xr::SessionBeginInfo,
) -> xr::Result {
    let Some(next) = next() else { return xr::Result::ERROR_RUNTIME_FAILURE };
    let Ok(mut simulated) = SESSION.lock() else { return xr::Result::ERROR_RUNTIME_FAILURE };
    if let Some(simulated) = &mut *simulated {
        use xr::SessionState as State;
        simulated.running = true;
        simulated.states.extend([State::SYNCHRONIZED, State::VISIBLE, State::FOCUSED]);
        return xr::Result::SUCCESS;
    }
    // SAFETY: passed on as it came.
    let begun = unsafe { (next.session.begin_session)(session, info) };
    let states = VecDeque::new();
    *simulated = Some(SimulatedSession { session, running: true, stopping: false, states });
    begun
}

unsafe extern "system" fn end_session(session: xr::Session) -> xr::Result {
    let Some(next) = next() else { return xr::Result::ERROR_RUNTIME_FAILURE };
    if let Ok(mut simulated) = SESSION.lock()
        && let Some(simulated) = simulated.as_mut().filter(|simulated| simulated.stopping)
    {
        simulated.running = false;
        simulated.states.push_back(xr::SessionState::IDLE);
        return xr::Result::SUCCESS;
    }
    // SAFETY: passed on as it came.
    unsafe { (next.session.end_session)(session) }
}

unsafe extern "system" fn wait_frame(
    session: xr::Session,
    info: *const xr::FrameWaitInfo,
    state: *mut xr::FrameState,
) -> xr::Result {
    let Some(next) = next() else { return xr::Result::ERROR_RUNTIME_FAILURE };
    let runs = SESSION
        .lock()
        .is_ok_and(|simulated| simulated.as_ref().is_some_and(|simulated| simulated.running));
    if !runs {
        return xr::Result::ERROR_SESSION_NOT_RUNNING;
    }
    // SAFETY: passed on as it came.
    unsafe { (next.session.wait_frame)(session, info, state) }
}
