//! 3MF files (3MF Core Specification 1.3) of a closed mesh: three XML texts in a ZIP archive, stored without compression.

use std::fmt::Write;
use tool_stock::stock::Mesh;

/// The name of a file that every archive has, and its text.
const CONTENT_TYPES: (&str, &str) = (
    "[Content_Types].xml",
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
     <Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">\
     <Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>\
     <Default Extension=\"model\" ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/></Types>\n",
);

/// The file that says where the model is.
const RELATIONSHIPS: (&str, &str) = (
    "_rels/.rels",
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
     <Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\
     <Relationship Target=\"/3D/3dmodel.model\" Id=\"rel0\" \
     Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>\n",
);

/// A 3MF file of a mesh; lengths in mm, rounded to 1e-6 mm. `description` says how exact it is.
pub fn three_mf(mesh: &Mesh, name: &str, description: &str) -> Vec<u8> {
    let mut model = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"millimeter\" xml:lang=\"en\" \
         xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n<metadata name=\"Title\">{}</metadata>\n\
         <metadata name=\"Description\">{}</metadata>\n<resources><object id=\"1\" type=\"model\"><mesh>\n<vertices>\n",
        escaped(name),
        escaped(description)
    );
    for p in &mesh.vertices {
        let _ = writeln!(model, "<vertex x=\"{:.6}\" y=\"{:.6}\" z=\"{:.6}\"/>", p.x, p.y, p.z);
    }
    model.push_str("</vertices>\n<triangles>\n");
    for [a, b, c] in &mesh.triangles {
        let _ = writeln!(model, "<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"/>");
    }
    model.push_str("</triangles>\n</mesh></object></resources>\n<build><item objectid=\"1\"/></build>\n</model>\n");
    archive(&[CONTENT_TYPES, RELATIONSHIPS, ("3D/3dmodel.model", &model)])
}

/// Text of an element: without characters that XML reserves or does not allow.
fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// Date of every file of an archive, 1980-01-01, the first that the format knows: the same job must give the same bytes.
const DATE: u16 = 0x21;

/// Version of the format that a reader needs: 1.0, stored files.
const VERSION: u16 = 10;

/// A ZIP archive of stored files (APPNOTE 6.3.10, sections 4.3.7, 4.3.12 and 4.3.16).
fn archive(files: &[(&str, &str)]) -> Vec<u8> {
    let mut out = Vec::new();
    let mut directory = Vec::new();
    for (name, text) in files {
        let at = number(out.len());
        let mut facts = Vec::new();
        // Version, flags, method, time, date.
        [VERSION, 0, 0, 0, DATE].iter().for_each(|x| facts.extend(x.to_le_bytes()));
        let size = number(text.len());
        [crc32fast::hash(text.as_bytes()), size, size].iter().for_each(|x| facts.extend(x.to_le_bytes()));
        facts.extend((name.len() as u16).to_le_bytes());
        // No extra field.
        facts.extend([0, 0]);
        out.extend(b"PK\x03\x04");
        out.extend(&facts);
        out.extend(name.bytes());
        out.extend(text.bytes());
        directory.extend(b"PK\x01\x02");
        directory.extend(VERSION.to_le_bytes());
        directory.extend(&facts);
        // Comment, disk, attributes.
        directory.extend([0; 10]);
        directory.extend(at.to_le_bytes());
        directory.extend(name.bytes());
    }
    let (at, size, count) = (number(out.len()), number(directory.len()), files.len() as u16);
    out.extend(directory);
    out.extend(b"PK\x05\x06");
    [0, 0, count, count].iter().for_each(|x: &u16| out.extend(x.to_le_bytes()));
    [size, at].iter().for_each(|x| out.extend(x.to_le_bytes()));
    out.extend([0, 0]);
    out
}

/// A length as the format has it: meshes are bounded far below 4 GB.
fn number(length: usize) -> u32 {
    u32::try_from(length).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;

    /// The archive by the rules of the format, read from its end, and XML that an own reader takes.
    #[test]
    fn a_tetrahedron() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let mesh = Mesh {
            vertices: corners.map(Point3::from).to_vec(),
            triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
        };
        let bytes = three_mf(&mesh, "a<b", "exact & closed");
        let u32_at = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        let u16_at = |at: usize| usize::from(u16::from_le_bytes(bytes[at..at + 2].try_into().unwrap()));
        let end = bytes.len() - 22;
        assert_eq!(&bytes[end..end + 4], b"PK\x05\x06");
        let (count, mut at) = (u16_at(end + 10), u32_at(end + 16));
        assert_eq!((count, at + u32_at(end + 12)), (3, end));
        for _ in 0..count {
            let (size, name, local) = (u32_at(at + 24), u16_at(at + 28), u32_at(at + 42));
            assert_eq!(bytes[local..local + 4], *b"PK\x03\x04");
            assert_eq!(bytes[at + 46..at + 46 + name], bytes[local + 30..local + 30 + name]);
            let text = &bytes[local + 30 + name..local + 30 + name + size];
            assert_eq!(u32_at(at + 16), u32_at(local + 14));
            let text = std::str::from_utf8(text).unwrap();
            let xml = roxmltree::Document::parse(text).unwrap();
            if bytes[at + 46..at + 46 + name].ends_with(b".model") {
                assert_eq!(
                    xml.descendants()
                        .filter(|n| n.has_tag_name("triangle") || n.tag_name().name() == "triangle")
                        .count(),
                    4
                );
                assert_eq!(xml.descendants().filter(|n| n.tag_name().name() == "vertex").count(), 4);
            }
            at += 46 + name;
        }
    }
}
