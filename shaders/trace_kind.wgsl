// Specialization constants of the tracer of final pictures, after those of kind.wgsl: what there is, and the most
// surfaces on a path after the one seen.

var<private> trace_bounces: u32 = 0x5bec0008u;
var<private> trace_sun: u32 = 0x5bec0009u;
var<private> trace_lamp: u32 = 0x5bec000au;
var<private> trace_ground: u32 = 0x5bec000bu;
var<private> trace_pupil: u32 = 0x5bec000cu;
