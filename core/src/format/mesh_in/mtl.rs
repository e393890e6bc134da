//! Reads `.mtl`, the materials of a Wavefront file: colours and textures.
//!
//! Anything missing or not allowed leaves a note, not an error: a mesh is useful without its colours.

use std::path::Path;
use std::sync::Arc;

use super::imported::within;
use crate::format::picture::load_picture;
use crate::format::store;
use crate::progress::Progress;
use crate::sculpture::Rgb;
use crate::voxelise::Skin;

/// Greatest size of a file of materials.
const LIMIT_BYTES: u64 = 16 << 20;

/// Materials by name.
#[derive(Default)]
pub struct Materials {
    names: Vec<String>,
    pub skins: Vec<Skin>,
    pub notes: Vec<String>,
    /// Number of files of materials that were named.
    asked: usize,
}

impl Materials {
    /// Returns the number of a material.
    pub fn number(&self, name: &str) -> Option<u32> {
        self.names.iter().position(|known| known == name).map(|at| at as u32)
    }

    /// Returns whether no file of materials was named.
    pub(crate) fn is_unasked(&self) -> bool {
        self.asked == 0
    }

    /// Uses an image beside the mesh as its texture, for a mesh that names no materials: one with the same name, or
    /// with the first part of the name and `_texture`. Returns whether there is one.
    pub fn beside(&mut self, mesh: &Path) -> bool {
        let stem = mesh.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let first = stem.split('_').next().unwrap_or("").to_string();
        let names = [stem.clone(), format!("{stem}_texture"), format!("{first}_texture")];
        let endings = ["png", "jpg", "jpeg"];
        let all = names.iter().flat_map(|name| endings.map(|ending| format!("{name}.{ending}")));
        for name in all {
            let path = mesh.with_file_name(&name);
            if !path.is_file() {
                continue;
            }
            match load_picture(&path) {
                Ok(picture) => {
                    let (colour, texture) = (Rgb::new(255, 255, 255), Some(Arc::new(picture)));
                    self.skins.push(Skin { colour, texture });
                    self.notes.push(format!("it names no texture; {name:?} beside it was taken"));
                    return true;
                }
                Err(error) => {
                    self.notes.push(format!("the texture {name:?} was not read: {error}"))
                }
            }
        }
        false
    }

    /// Adds the materials of the files that a line names: one whose name may have spaces, or several.
    pub(crate) fn load_all(&mut self, names: &str, folder: &Path) {
        let is_one = within(folder, names).is_some_and(|path| path.is_file());
        let several: Vec<&str> = names.split_ascii_whitespace().collect();
        if is_one || several.len() < 2 {
            return self.load(names, folder);
        }
        // If none of them exists, the whole name is reported as missing.
        let is_there = |name: &&str| within(folder, name).is_some_and(|path| path.is_file());
        if !several.iter().any(is_there) {
            return self.load(names, folder);
        }
        several.into_iter().for_each(|name| self.load(name, folder));
    }

    /// Adds the materials of a file.
    fn load(&mut self, name: &str, folder: &Path) {
        self.asked += 1;
        let Some(path) = within(folder, name) else {
            self.notes
                .push(format!("materials outside the folder of the mesh were not read: {name:?}"));
            return;
        };
        let quiet: &dyn Progress = &();
        let file = match store::read(&path, LIMIT_BYTES, |_| Ok(()), quiet) {
            Ok(file) => file,
            Err(error) => {
                self.notes.push(format!("the materials {name:?} cannot be read: {error}"));
                return;
            }
        };
        for line in String::from_utf8_lossy(&file).lines() {
            let line = line.trim();
            let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
            let rest = rest.trim();
            match (word, self.skins.last_mut()) {
                ("newmtl", _) => {
                    self.names.push(rest.to_string());
                    self.skins.push(Skin { colour: Rgb::new(255, 255, 255), texture: None });
                }
                ("Kd", Some(skin)) if skin.texture.is_none() => {
                    let mut levels =
                        rest.split_ascii_whitespace().map_while(|w| w.parse::<f32>().ok());
                    if let (Some(r), Some(g), Some(b)) =
                        (levels.next(), levels.next(), levels.next())
                    {
                        skin.colour = Rgb([r, g, b].map(|v| (v * 255.0).round() as u8));
                    }
                }
                ("map_Kd", Some(_)) => self.texture(rest, folder),
                _ => {}
            }
        }
    }

    /// Sets the texture of the last material.
    fn texture(&mut self, rest: &str, folder: &Path) {
        // Options precede the name, which alone may have spaces.
        let name = if rest.starts_with('-') { rest.rsplit(' ').next().unwrap_or("") } else { rest };
        let found = within(folder, name).ok_or("it is outside the folder of the mesh".to_string());
        let loaded = found.and_then(|path| load_picture(&path).map_err(|error| error.to_string()));
        match (loaded, self.skins.last_mut()) {
            (Ok(picture), Some(skin)) => {
                skin.texture = Some(Arc::new(picture));
                skin.colour = Rgb::new(255, 255, 255);
            }
            (Err(error), _) => {
                self.notes.push(format!("the texture {name:?} was not read: {error}"))
            }
            (Ok(_), None) => {}
        }
    }
}
