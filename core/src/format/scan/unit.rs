//! Converts units of length, by their names in file formats.

/// Returns the millimetres of a unit; 1 if none is named, `None` if it is unknown. Names are in lower case.
pub(crate) fn mm_per_unit(unit: &str) -> Option<f64> {
    Some(match unit {
        "" | "mm" | "millimeter" | "millimeters" | "millimetre" | "millimetres" => 1.0,
        "m" | "meter" | "meters" | "metre" | "metres" => 1e3,
        "cm" | "centimeter" | "centimeters" | "centimetre" | "centimetres" => 10.0,
        "dm" => 100.0,
        "km" => 1e6,
        // Both signs for micro, and ImageJ's spelling of one.
        "um" | "\u{B5}m" | "\u{3BC}m" | "\\u00b5m" | "micron" | "microns" | "micrometer"
        | "micrometers" | "micrometre" | "micrometres" => 1e-3,
        "nm" | "nanometer" | "nanometers" | "nanometre" | "nanometres" => 1e-6,
        "pm" => 1e-9,
        "angstrom" | "angstroms" | "\u{C5}" | "\u{E5}" => 1e-7,
        "in" | "inch" | "inches" => 25.4,
        "ft" | "foot" | "feet" => 304.8,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_unit_has_many_names() {
        for name in ["um", "\u{B5}m", "\u{3BC}m", "\\u00b5m", "micron"] {
            assert_eq!(mm_per_unit(name), Some(1e-3), "{name}");
        }
        assert_eq!(mm_per_unit("pixel"), None);
    }
}
