//! The words of arguments that choose one of the core's values: its names, each with the line that `--help` shows.
//!
//! The core knows no command line, so these lines stand here; the compiler asks for one for each value.

use std::str::FromStr;

use clap::builder::{PossibleValue, PossibleValuesParser, StyledStr, TypedValueParser};

use crate::format::{MeshUp, meshes_with_up_text};
use crate::mesh::MeshKind;
use crate::view::StereoLayout;

/// Returns the surfaces of a mesh.
pub fn surfaces() -> impl TypedValueParser<Value = MeshKind> {
    one_of(MeshKind::NAMED, |kind| match kind {
        MeshKind::Faces => "Each exposed face of a voxel",
        MeshKind::Greedy => "The exposed faces, merged to rectangles where they lie in a plane",
        MeshKind::Smooth => "The smooth surface that pictures show",
    })
}

/// Returns the axes that can point up in a mesh.
pub fn up_axes() -> impl TypedValueParser<Value = MeshUp> {
    one_of(MeshUp::NAMED, |up| {
        let meshes = meshes_with_up_text(up);
        match up {
            MeshUp::Y => format!("As in the sculpture: the default in {meshes}"),
            MeshUp::Z => format!("As on a printer's bed: the default in {meshes}"),
        }
    })
}

/// Returns the layouts of two pictures on a screen.
pub fn layouts() -> impl TypedValueParser<Value = StereoLayout> {
    one_of(StereoLayout::ALL.map(|layout| (layout, layout.name())), |layout| match layout {
        StereoLayout::Mono => "One picture for both eyes",
        StereoLayout::Layers => "A layer an eye of a quad-buffered window",
        StereoLayout::SideBySide => "Left and right half, each squeezed, as 3D televisions take it",
        StereoLayout::TopBottom => "Upper and lower half, each squeezed",
        StereoLayout::Rows => "Even rows for the left eye, odd rows for the right one",
        StereoLayout::Columns => "Even columns for the left eye, odd columns for the right one",
        StereoLayout::Anaglyph => "Red for the left eye, green and blue for the right one",
    })
}

/// Takes the names of `values` and nothing else; `help` gives the line for each.
fn one_of<T, const N: usize, H: Into<StyledStr>>(
    values: [(T, &'static str); N],
    help: fn(T) -> H,
) -> impl TypedValueParser<Value = T>
where
    T: FromStr<Err = String> + Clone + Send + Sync + 'static,
{
    let words = values.map(|(value, name)| PossibleValue::new(name).help(help(value)));
    PossibleValuesParser::new(words).try_map(|word| word.parse::<T>())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn takes<T>(parser: impl TypedValueParser<Value = T>, values: &[(T, &str)])
    where
        T: Clone + PartialEq + std::fmt::Debug + Send + Sync + 'static,
    {
        let argument = clap::Arg::new("choice").long("choice").value_parser(parser);
        let command = clap::Command::new("test").arg(argument);
        for (value, name) in values {
            let matches = command.clone().try_get_matches_from(["test", "--choice", name]);
            assert_eq!(matches.unwrap().get_one::<T>("choice"), Some(value), "{name}");
        }
        let refused = command.try_get_matches_from(["test", "--choice", "none"]).unwrap_err();
        assert_eq!(refused.kind(), clap::error::ErrorKind::InvalidValue);
        let said = refused.to_string();
        assert!(values.iter().all(|(_, name)| said.contains(name)), "{said}");
    }

    #[test]
    fn arguments_take_the_names_of_the_core() {
        takes(surfaces(), &MeshKind::NAMED);
        takes(up_axes(), &MeshUp::NAMED);
        takes(layouts(), &StereoLayout::ALL.map(|layout| (layout, layout.name())));
    }
}
