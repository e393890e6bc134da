//! Resolves the URIs of a glTF file: data in the URI itself (`data:`), or a file in its folder or below. Nothing else
//! is read, whatever the URI says.

use std::cell::Cell;
use std::path::Path;

use super::imported::within;
use crate::format::error::excerpt;
use crate::format::scan::base64;
use crate::format::{FormatError, store};
use crate::progress::Progress;

/// The folder of a glTF file, and what may be read from it.
pub struct GltfFolder<'a> {
    folder: &'a Path,
    /// Number of bytes that all files together may still take.
    left_bytes: Cell<u64>,
    progress: &'a dyn Progress,
}

impl<'a> GltfFolder<'a> {
    /// Creates it for the file at `path`; all files that it names may take `budget_bytes` together.
    pub fn new(path: &'a Path, budget_bytes: u64, progress: &'a dyn Progress) -> GltfFolder<'a> {
        let folder = path.parent().unwrap_or(Path::new(""));
        GltfFolder { folder, left_bytes: Cell::new(budget_bytes), progress }
    }

    /// Returns the bytes that a URI names.
    pub fn read(&self, uri: &str) -> Result<Vec<u8>, FormatError> {
        let refused = |name: &str, why: &str| FormatError::Beside {
            name: excerpt(name.as_bytes()),
            why: why.to_string(),
        };
        if let Some(data) = uri.strip_prefix("data:") {
            let text = data.split_once(";base64,").map(|(_, text)| text.as_bytes());
            let bytes = text.and_then(|text| base64::decode(text, text.len()));
            return bytes.ok_or_else(|| refused(uri, "what it holds is not written as base64"));
        }
        let name = unescaped(uri).ok_or_else(|| refused(uri, "that is not text"))?;
        // The folder of a mesh may be untrusted, and so may the files that it requests.
        let path = within(self.folder, &name)
            .filter(|_| !name.contains(':'))
            .ok_or_else(|| refused(&name, "it lies outside the folder of the mesh"))?;
        let left = self.left_bytes.get();
        let file = store::read(&path, left, |_| Ok(()), self.progress);
        let file = file.map_err(|error| match error {
            FormatError::Cancelled | FormatError::OverBudget(_) => error,
            error => FormatError::Beside { name, why: format!("it cannot be read ({error})") },
        })?;
        self.left_bytes.set(left.saturating_sub(file.len() as u64));
        Ok(file)
    }
}

/// Decodes percent-escapes in a URI. `None` if the result is not text.
fn unescaped(uri: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, after @ ..] = rest {
        let hex = after.get(..2).filter(|_| *first == b'%');
        let code = hex.and_then(|hex| u8::from_str_radix(std::str::from_utf8(hex).ok()?, 16).ok());
        bytes.push(code.unwrap_or(*first));
        rest = if code.is_some() { &after[2..] } else { after };
    }
    String::from_utf8(bytes).ok().filter(|name| !name.contains('\0'))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::refusal::{MemoryBudget, OverBudget};

    #[test]
    fn only_what_lies_in_the_folder_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let inside = folder.path().join("in");
        std::fs::create_dir_all(inside.join("deep er")).unwrap();
        std::fs::write(inside.join("deep er/a.bin"), b"1234").unwrap();
        std::fs::write(folder.path().join("secret.bin"), b"secret").unwrap();
        let mesh = inside.join("a.gltf");
        let beside = GltfFolder::new(&mesh, 9, &());
        assert_eq!(beside.read("data:a/b;base64,AQID").unwrap(), [1, 2, 3]);
        assert_eq!(beside.read("deep%20er/a.bin").unwrap(), b"1234");
        let secret = folder.path().join("secret.bin");
        for (uri, part) in [
            ("../secret.bin", "outside"),
            ("%2e%2e/secret.bin", "outside"),
            ("deep er/..\\../../secret.bin", "outside"),
            (secret.to_str().unwrap(), "outside"),
            ("file:secret.bin", "outside"),
            ("https://example.org/a.bin", "outside"),
            ("", "outside"),
            ("none.bin", "cannot be read"),
            ("deep er", "cannot be read"),
            ("%ff", "not text"),
            ("%00", "not text"),
            ("data:,hello", "base64"),
            ("data:;base64,**", "base64"),
        ] {
            let error = beside.read(uri).unwrap_err().to_string();
            assert!(error.contains(part) && error.contains(".glb"), "{uri}: {error}");
        }
        // Five bytes are left of nine.
        assert_eq!(beside.read("./deep er/a.bin").unwrap(), b"1234");
        assert!(matches!(
            beside.read("deep er/a.bin"),
            Err(FormatError::OverBudget(OverBudget { budget: MemoryBudget::GridsAndColours, .. }))
        ));
    }
}
