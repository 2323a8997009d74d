//! A file for ParaView, read back.

/// The header of a file, and its arrays by name in their order, behind each other with nothing left over.
pub fn parse(file: &[u8]) -> (String, Vec<(String, Vec<u8>)>) {
    let mark = b"<AppendedData encoding=\"raw\">\n_";
    let start = file.windows(mark.len()).position(|window| window == mark).expect("appended data") + mark.len();
    let (header, data) = file.split_at(start);
    let header = String::from_utf8(header.to_vec()).expect("text");
    let (mut end, mut arrays) = (0, Vec::new());
    for element in header.split("<DataArray ").skip(1) {
        assert_eq!(value(element, "offset"), end.to_string(), "arrays follow each other");
        let size = u64::from_le_bytes(data[end..end + 8].try_into().expect("eight bytes")) as usize;
        arrays.push((value(element, "Name").to_string(), data[end + 8..][..size].to_vec()));
        end += 8 + size;
    }
    assert!(end > 0 && data[end..].starts_with(b"\n</AppendedData>"), "nothing is left over");
    (header, arrays)
}

/// The first value of an attribute.
pub fn value<'a>(text: &'a str, name: &str) -> &'a str {
    let (_, rest) = text.split_once(&format!("{name}=\"")).expect("an attribute");
    rest.split('"').next().expect("its value")
}
