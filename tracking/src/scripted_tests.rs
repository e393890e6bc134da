//! Properties of the scripted source.

use super::*;

fn x_of(event: &Event) -> Option<(f64, f64)> {
    match event {
        Event::Pose(pose) => Some((pose.time_s, pose.placement.position_m.x)),
        _ => None,
    }
}

fn play(text: &str, times: impl IntoIterator<Item = f64>) -> Vec<Event> {
    let mut source = Scripted::new("script", Script::parse(text).unwrap());
    let mut events = Vec::new();
    for now_s in times {
        source.poll(now_s, &mut events);
    }
    events
}

const SCRIPT: &str = "
# a head that moves right
0.0  0 0 0.6  0 0 0 1
1.0  0.5 0 0.6  0 0 0 1  0.5
1.5  button 2 down
2.0  1 0 0.6  0 0 0 1
2.0  button 2 up
";

#[test]
fn entries_are_reported_when_due_whatever_the_frames() {
    let expected = vec![(10.0, 0.0), (11.0, 0.5), (12.0, 1.0)];
    for step in [0.001, 0.016, 0.3, 5.0] {
        let times = (0..).map(|i| 10.0 + f64::from(i) * step).take_while(|t| *t < 15.1);
        let events = play(SCRIPT, times);
        let poses: Vec<_> = events.iter().filter_map(x_of).collect();
        assert_eq!(poses, expected, "step {step}");
        let buttons: Vec<_> = events
            .iter()
            .filter_map(|event| match event {
                Event::Button { button, pressed, time_s, .. } => Some((*button, *pressed, *time_s)),
                _ => None,
            })
            .collect();
        assert_eq!(buttons, [(2, true, 11.5), (2, false, 12.0)]);
    }
    let events = play(SCRIPT, [10.0, 10.999]);
    assert_eq!(events.len(), 1, "nothing before its time");
}

#[test]
fn a_rate_interpolates() {
    let text = format!("rate 50\n{SCRIPT}");
    for step in [0.02, 0.0166, 0.25] {
        let times = (0..).map(|i| f64::from(i) * step).take_while(|t| *t < 3.0);
        let poses: Vec<_> = play(&text, times).iter().filter_map(x_of).collect();
        assert_eq!(poses.len(), 101, "step {step}");
        for (tick, (t, x)) in poses.iter().enumerate() {
            assert!((t - tick as f64 / 50.0).abs() < 1e-9);
            assert!((x - 0.5 * t).abs() < 1e-9);
        }
    }
}

#[test]
fn loops_and_skips_ahead() {
    let text = format!("loop\n{SCRIPT}");
    let times = (0..701).map(|i| f64::from(i) * 0.01);
    let poses: Vec<_> = play(&text, times).iter().filter_map(x_of).collect();
    let xs: Vec<_> = poses.iter().map(|(_, x)| *x).collect();
    assert_eq!(xs, [0.0, 0.5, 1.0, 0.0, 0.5, 1.0, 0.0, 0.5, 1.0, 0.0, 0.5]);
    assert!(poses.windows(2).all(|w| w[0].0 <= w[1].0));

    let text = format!("rate 1000\n{text}");
    let mut source = Scripted::new("script", Script::parse(&text).unwrap());
    let mut events = Vec::new();
    source.poll(0.0, &mut events);
    events.clear();
    source.poll(1.0e5 + 0.25, &mut events);
    assert!(events.len() <= MAX_AT_ONCE + 4);
    let (t, x) = events.iter().filter_map(x_of).next_back().unwrap();
    assert!((t - 100_000.25).abs() < 1e-6 && (x - 0.125).abs() < 1e-6);
    assert_eq!(source.state(), SourceState::Running);
}

#[test]
fn loss_and_sensors() {
    let text =
        "rate 10\nsensor 3\n0 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n1 lost\n2 2 0 0 0 0 0 1\n3 lost";
    let script = Script::parse(text).unwrap();
    assert_eq!(script.at(3, 0.5).unwrap().0.position_m.x, 0.5);
    assert!(script.at(3, 1.5).is_none() && script.at(0, 0.5).is_none());
    assert_eq!(script.at(3, 2.5).unwrap().0.position_m.x, 2.0, "not towards a loss");
    let events = play(text, (0..40).map(|i| f64::from(i) * 0.1));
    assert_eq!(events.iter().filter(|e| matches!(e, Event::Lost { .. })).count(), 2);
    assert!(events.iter().all(|e| !matches!(e, Event::Pose(p) if p.sensor != 3)));
}

#[test]
fn ends_and_says_so() {
    let mut source = Scripted::new("script", Script::parse(SCRIPT).unwrap());
    let mut events = Vec::new();
    source.poll(0.0, &mut events);
    assert_eq!(source.state(), SourceState::Running);
    source.poll(2.0, &mut events);
    assert!(matches!(source.state(), SourceState::Ended(_)));
    assert_eq!(source.counters().accepted, 5);
}

#[test]
fn errors_name_the_line() {
    for (text, line) in [
        ("0 0 0 0 0 0 0 0", 1),
        ("\n0 0 0 0 0 0 0 nan", 2),
        ("0 0 0 0 0 0 0 1 2", 1),
        ("1 lost\n0 lost", 2),
        ("-1 lost", 1),
        ("0 0 0", 1),
        ("0 button 256 down", 1),
        ("0 button 1 sideways", 1),
        ("rate 0", 1),
        ("rate inf", 1),
        ("sensor -1", 1),
        ("1e300 lost", 1),
        ("loop", 1),
        ("", 1),
        ("rate 60 # and no pose", 1),
        ("loop\n0 lost", 1),
        ("0 1e99 0 0 0 0 0 1", 1),
    ] {
        assert_eq!(Script::parse(text).map_err(|error| error.line), Err(line), "{text:?}");
    }
}

proptest::proptest! {
    #[test]
    fn no_text_breaks_the_reader(text in "([0-9.eE+-]{1,4}|loop|rate|sensor|lost|button|down|[ \n#]){0,60}") {
        if let Ok(script) = Script::parse(&text) {
            let mut source = Scripted::new("script", script);
            for now_s in [0.0, 0.1, 1.0, 1.0e9] {
                source.poll(now_s, &mut Vec::new());
            }
        }
    }
}
