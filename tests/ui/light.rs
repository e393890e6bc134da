//! The lights dialog: lamps are added, placed and removed, and the renderer receives them.

use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use virtual_sculpture::render::{RenderMode, Shading};
use virtual_sculpture::shade::{
    LightFrame, LightSource, Lighting, Look, Matcap, Smoothing, ToneMapping,
};
use virtual_sculpture::ui::dialogs::look;

use super::bench::{Bench, bench, bench_of, click, config, key, rest};

fn lighting(harness: &Bench) -> Lighting {
    harness.state().ui.view.lighting()
}

#[test]
fn lamps_are_added_placed_and_taken_away() {
    let mut harness = bench();
    assert!(harness.query_by_label("Add light").is_none());
    key(&mut harness, Modifiers::NONE, Key::F4);
    let lamp = lighting(&harness).lights[0].unwrap();
    assert!(matches!(lamp.source, LightSource::Direction(_)) && lamp.frame == LightFrame::Eye);
    click(&mut harness, "world");
    click(&mut harness, "Point");
    let lamp = lighting(&harness).lights[0].unwrap();
    assert!(matches!(lamp.source, LightSource::Position(_)) && lamp.frame == LightFrame::World);

    for _ in 0..3 {
        click(&mut harness, "Add light");
    }
    assert_eq!(lighting(&harness).lights.iter().flatten().count(), 4);
    click(&mut harness, "Add light");
    assert_eq!(harness.state().ui.view.light.lamps.len(), 4, "there is room for four");
    let places = harness.state().ui.view.light.lamps.clone();
    harness.run_steps(10);
    assert_eq!(harness.state().ui.view.light.lamps, places, "no lamp moves by being looked at");
    click(&mut harness, "Light 2");
    assert!(lighting(&harness).lights[1].is_none(), "off is not away");
    assert_eq!(harness.state().ui.view.light.lamps.len(), 4);
    harness.get_all_by_label("Remove").next().unwrap().click();
    harness.run_steps(6);
    rest(&mut harness);
    assert_eq!(harness.state().ui.view.light.lamps.len(), 3);
    assert!(lighting(&harness).lights[0].is_none(), "the second is the first now");

    click(&mut harness, "Reset lights");
    assert_eq!(harness.state().ui.view.light, Default::default());
    key(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(harness.query_by_label("Add light").is_none(), "Escape closes the window");
}

#[test]
fn reset_goes_back_to_what_the_settings_say() {
    let mut config = config(16);
    config.light.exposure = 0.75;
    config.light.lamps.truncate(1);
    let mut harness = bench_of(&config, egui::vec2(1280.0, 800.0));
    key(&mut harness, Modifiers::NONE, Key::F4);
    click(&mut harness, "Add light");
    assert_ne!(harness.state().ui.view.light, config.light);
    click(&mut harness, "Reset lights");
    assert_eq!(harness.state().ui.view.light, config.light);
}

#[test]
fn the_finish_is_chosen_where_it_can_be_had() {
    let mut harness = bench();
    key(&mut harness, Modifiers::NONE, Key::F4);
    assert!(lighting(&harness).occlusion, "on unless somebody switches it off");
    click(&mut harness, "Ambient occlusion");
    assert!(!lighting(&harness).occlusion);
    assert_eq!(lighting(&harness).tone, ToneMapping::Filmic);
    click(&mut harness, "Filmic tone mapping");
    assert_eq!(lighting(&harness).tone, ToneMapping::Off);
    assert_eq!(lighting(&harness).shadow, None);
    click(&mut harness, "Shadows");
    assert!(lighting(&harness).shadow.is_some_and(|shadow| shadow.sun_deg == 4.0));
    click(&mut harness, "Smooth normals");
    click(&mut harness, "5 × 5");
    assert_eq!(lighting(&harness).smooth_normals, Smoothing::Wide);
    assert_eq!(lighting(&harness).smooth_colours, Smoothing::Off);
    // Only the software shader has filters.
    harness.state_mut().ui.view.mode = RenderMode::MarchGpu;
    rest(&mut harness);
    click(&mut harness, "Smooth normals");
    assert!(harness.query_by_label("3 × 3").is_none());
}

#[test]
fn a_look_is_chosen_and_a_matcap_read_or_refused_with_its_reason() {
    let mut harness = bench();
    key(&mut harness, Modifiers::NONE, Key::F4);
    assert_eq!(lighting(&harness).look, Look::Colours);
    assert!(harness.query_by_label("Choose a matcap …").is_none());
    for (label, look) in [("Clay", Look::Clay), ("Stone", Look::Stone), ("Matcap", Look::Matcap)] {
        // A brush is called Clay, too; the window of lights comes after it.
        harness.get_all_by_label(label).last().unwrap().click();
        rest(&mut harness);
        assert_eq!(lighting(&harness).look, look);
    }
    assert_eq!(lighting(&harness).matcap, Matcap::built_in());

    let folder = tempfile::tempdir().unwrap();
    let (good, bad) = (folder.path().join("ball.png"), folder.path().join("strip.png"));
    image::RgbImage::from_pixel(64, 64, image::Rgb([90, 200, 30])).save(&good).unwrap();
    image::RgbImage::from_pixel(64, 32, image::Rgb([90, 200, 30])).save(&bad).unwrap();
    for path in [&good, &bad] {
        let ui = &mut harness.state_mut().ui;
        look::take_matcap(&mut ui.view, &mut ui.toasts, path.clone());
        rest(&mut harness);
        assert_eq!(lighting(&harness).matcap.texels()[0].to_le_bytes(), [90, 200, 30, 255]);
        assert_eq!(harness.state().ui.view.light.matcap.path(), Some(good.as_path()));
    }
    let said: Vec<String> =
        harness.state().ui.toasts.texts().map(|(_, text)| text.to_string()).collect();
    assert!(
        said.iter().any(|text| text.contains("strip.png") && text.contains("64 x 32")),
        "{said:?}"
    );
    click(&mut harness, "Built-in");
    assert_eq!(lighting(&harness).matcap, Matcap::built_in());
    click(&mut harness, "True colours");
    assert_eq!(lighting(&harness).look, Look::Colours);
}

#[test]
fn every_mode_is_reached_by_its_key() {
    let mut harness = bench();
    let mut met = Vec::new();
    for _ in RenderMode::ALL {
        met.push(harness.state().ui.view.mode);
        key(&mut harness, Modifiers::NONE, Key::M);
    }
    assert_eq!(met, RenderMode::ALL);
    assert_eq!(harness.state().ui.view.mode, met[0]);
    assert!(met.iter().any(|mode| mode.shading() == Shading::Points));
}
