//! The appended block of a VTK file: for each array its size in bytes and its numbers, all little-endian.

/// The appended block with the arrays that were added so far.
#[derive(Debug, Default)]
pub(super) struct Appended {
    bytes: Vec<u8>,
}

impl Appended {
    /// Adds numbers, vectors of two filled up to three as VTK wants them; gives the element that refers to
    /// them.
    pub(super) fn floats(&mut self, name: &str, components: usize, values: &[f64]) -> String {
        let written = if components == 2 { 3 } else { components };
        let filled = values.chunks(components).flat_map(|v| v.iter().copied().chain((v.len()..written).map(|_| 0.0)));
        let numbers: Vec<u8> = filled.flat_map(f64::to_le_bytes).collect();
        self.add("Float64", name, written, &numbers)
    }

    pub(super) fn integers(&mut self, name: &str, values: &[i64]) -> String {
        let numbers: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.add("Int64", name, 1, &numbers)
    }

    pub(super) fn bytes(&mut self, name: &str, values: &[u8]) -> String {
        self.add("UInt8", name, 1, values)
    }

    pub(super) fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }

    fn add(&mut self, kind: &str, name: &str, components: usize, numbers: &[u8]) -> String {
        let (offset, name) = (self.bytes.len(), crate::svg::escape(name));
        self.bytes.extend((numbers.len() as u64).to_le_bytes());
        self.bytes.extend(numbers);
        format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"appended\" \
             offset=\"{offset}\"/>\n"
        )
    }
}
