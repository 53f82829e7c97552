//! The MTL reader. Forgiving, since nearly every odd MTL file still has something to show: what cannot be read is warned about and keeps its
//! default, where `tobj` 4.0.5 refuses the whole file.

use crate::lines::{LineTooLong, Lines, number, shown, word, words};

/// A material as read, its maps still file names.
#[derive(Clone, Debug, Default)]
pub(crate) struct MtlMaterial {
    pub(crate) name: String,
    pub(crate) diffuse: Option<[f32; 3]>,
    pub(crate) specular: Option<[f32; 3]>,
    pub(crate) shininess: Option<f32>,
    pub(crate) emission: Option<[f32; 3]>,
    pub(crate) dissolve: Option<f32>,
    pub(crate) transparency: Option<f32>,
    pub(crate) index_of_refraction: Option<f32>,
    pub(crate) illumination: Option<u32>,
    pub(crate) diffuse_map: Option<Map>,
    pub(crate) specular_map: Option<Map>,
    pub(crate) emission_map: Option<Map>,
    pub(crate) opacity_map: Option<Map>,
    pub(crate) bump_map: Option<Map>,
    pub(crate) normal_map: Option<Map>,
}

/// A texture statement.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Map {
    pub(crate) file: String,
    pub(crate) line: u64,
    /// `-bm`, 1 where absent.
    pub(crate) bump_scale: f32,
}

/// Reads the bytes of an MTL file; `file` is its name in warnings.
pub(crate) fn parse(bytes: &[u8], file: &str, warnings: &mut Vec<String>) -> Vec<MtlMaterial> {
    let mut materials: Vec<MtlMaterial> = Vec::new();
    let mut reader = Reader { file, line: 0, told: 0, warnings };
    for line in Lines::new(bytes) {
        let (number, line) = match line {
            Ok(line) => line,
            Err(LineTooLong(number)) => {
                reader.line = number;
                reader.warn("the line is too long; the rest of the file is not read".to_owned());
                break;
            }
        };
        reader.line = number;
        let (keyword, rest) = word(&line);
        let keyword = keyword.to_ascii_lowercase();
        if keyword == b"newmtl" {
            materials.push(MtlMaterial { name: String::from_utf8_lossy(rest).into_owned(), ..MtlMaterial::default() });
        } else if let Some(material) = materials.last_mut() {
            reader.statement(&keyword, rest, material);
        }
    }
    materials
}

struct Reader<'a> {
    file: &'a str,
    line: u64,
    told: u32,
    warnings: &'a mut Vec<String>,
}

impl Reader<'_> {
    /// At most a hundred a file: a file of rubbish shall not fill the memory with complaints.
    fn warn(&mut self, message: String) {
        let message = format!("{}:{}: {message}", self.file, self.line);
        self.told += 1;
        if self.told <= 100 {
            self.warnings.push(message);
        }
    }

    fn statement(&mut self, keyword: &[u8], rest: &[u8], material: &mut MtlMaterial) {
        match keyword {
            b"kd" => material.diffuse = self.colour("Kd", rest).or(material.diffuse),
            b"ks" => material.specular = self.colour("Ks", rest).or(material.specular),
            b"ke" => material.emission = self.colour("Ke", rest).or(material.emission),
            b"ns" => material.shininess = self.value("Ns", rest, 0.0, 1e6).or(material.shininess),
            b"ni" => material.index_of_refraction = self.value("Ni", rest, 0.0, 1e3).or(material.index_of_refraction),
            b"d" => {
                let rest = rest.strip_prefix(b"-halo").unwrap_or(rest);
                material.dissolve = self.value("d", rest, 0.0, 1.0).or(material.dissolve);
            }
            b"tr" => material.transparency = self.value("Tr", rest, 0.0, 1.0).or(material.transparency),
            b"illum" => material.illumination = self.value("illum", rest, 0.0, 10.0).map(|value| value as u32).or(material.illumination),
            b"map_kd" => material.diffuse_map = self.map("map_Kd", rest).or(material.diffuse_map.take()),
            b"map_ks" => material.specular_map = self.map("map_Ks", rest).or(material.specular_map.take()),
            b"map_ke" => material.emission_map = self.map("map_Ke", rest).or(material.emission_map.take()),
            b"map_d" | b"map_opacity" => material.opacity_map = self.map("map_d", rest).or(material.opacity_map.take()),
            b"map_bump" | b"bump" => material.bump_map = self.map("map_bump", rest).or(material.bump_map.take()),
            b"norm" | b"map_kn" | b"map_norm" => material.normal_map = self.map("norm", rest).or(material.normal_map.take()),
            _ => {}
        }
    }

    /// One number is grey. Values that are negative or no numbers are refused.
    fn colour(&mut self, keyword: &str, rest: &[u8]) -> Option<[f32; 3]> {
        let mut values = words(rest).map(number);
        let colour = match (values.next().flatten(), values.next(), values.next()) {
            (Some(grey), None, _) => Some([grey; 3]),
            (Some(red), Some(Some(green)), Some(Some(blue))) => Some([red, green, blue]),
            _ => None,
        };
        let colour = colour.filter(|colour| colour.iter().all(|&value| value.is_finite() && value >= 0.0));
        if colour.is_none() {
            self.warn(format!(
                "\"{keyword} {}\" is no colour and is not used; write {keyword} red green blue, each 0 or more",
                shown(rest)
            ));
        }
        colour
    }

    fn value(&mut self, keyword: &str, rest: &[u8], low: f32, high: f32) -> Option<f32> {
        let value = words(rest).next().and_then(number).filter(|value| value.is_finite());
        if value.is_none() {
            self.warn(format!("\"{keyword} {}\" is no number and is not used", shown(rest)));
        }
        value.map(|value| value.clamp(low, high))
    }

    /// Options, then a file name, which may hold blanks.
    fn map(&mut self, keyword: &str, rest: &[u8]) -> Option<Map> {
        let mut bump_scale = 1.0;
        let mut rest = rest;
        while let (option @ [b'-', ..], after) = word(rest) {
            let (least, most) = match option {
                b"-blendu" | b"-blendv" | b"-cc" | b"-clamp" | b"-texres" | b"-imfchan" | b"-type" | b"-boost" | b"-bm"
                | b"-colorspace" => (1, 1),
                b"-mm" => (2, 2),
                b"-o" | b"-s" | b"-t" => (1, 3),
                _ => break,
            };
            rest = after;
            for at in 0..most {
                let (value, after) = word(rest);
                let number = number(value);
                // The second and third number of an offset are optional; the file's name follows them.
                if value.is_empty() || (at >= least && number.is_none()) {
                    break;
                }
                if let (b"-bm", Some(scale)) = (option, number.filter(|scale| scale.is_finite())) {
                    bump_scale = scale;
                }
                rest = after;
            }
            if matches!(option, b"-o" | b"-s" | b"-t") {
                self.warn(format!("{keyword}: {} is not applied; scale or move the texture coordinates instead", shown(option)));
            }
        }
        let file = String::from_utf8_lossy(rest).into_owned();
        let file = file.strip_prefix('"').and_then(|file| file.strip_suffix('"')).unwrap_or(&file).to_owned();
        if file.is_empty() {
            self.warn(format!("{keyword} names no file"));
            return None;
        }
        Some(Map { file, line: self.line, bump_scale })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> (Vec<MtlMaterial>, Vec<String>) {
        let mut warnings = Vec::new();
        let materials = parse(text.as_bytes(), "m.mtl", &mut warnings);
        (materials, warnings)
    }

    #[test]
    fn options_before_a_name_with_blanks() {
        let (materials, warnings) =
            read("newmtl a b\nmap_bump -bm 0.5 -o 1 2 my file.png\nmap_Kd -blendu on \"c d.png\"\nmap_d -s 1 1 1 2.png");
        assert_eq!(materials[0].name, "a b");
        assert_eq!(materials[0].bump_map, Some(Map { file: "my file.png".to_owned(), line: 2, bump_scale: 0.5 }));
        assert_eq!(materials[0].diffuse_map.as_ref().map(|map| map.file.as_str()), Some("c d.png"));
        assert_eq!(materials[0].opacity_map.as_ref().map(|map| map.file.as_str()), Some("2.png"));
        assert_eq!(warnings.len(), 2, "{warnings:?}");
    }

    #[test]
    fn what_cannot_be_read_keeps_its_default_and_is_told() {
        let (materials, warnings) = read("Kd 1 1 1\nnewmtl a\nKd spectral x.rfl\nKs 0.5\nNs nan\nd 7\nTr 0.25\nillum 3\nmap_Kd\n");
        let material = &materials[0];
        assert_eq!((material.diffuse, material.specular, material.shininess), (None, Some([0.5; 3]), None));
        assert_eq!((material.dissolve, material.transparency, material.illumination), (Some(1.0), Some(0.25), Some(3)));
        assert_eq!(warnings.len(), 3, "{warnings:?}");
    }
}
