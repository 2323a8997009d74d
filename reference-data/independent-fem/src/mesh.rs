//! Tensor-product meshes of the plate, and arrays of nodal values on them.

/// Length of the plate, m.
pub const LENGTH: f64 = 0.1;
/// Half its height, m; the crack lies on y = 0.
pub const HALF_HEIGHT: f64 = 0.02;
/// Length of the initial crack, from the left edge, m.
pub const CRACK: f64 = 0.05;

/// Node lines of a rectangular mesh.
#[derive(Debug, Clone)]
pub struct Mesh {
    /// Abscissae of the node columns, m.
    pub x: Vec<f64>,
    /// Ordinates of the node rows, m.
    pub y: Vec<f64>,
}

/// How spans grow away from the crack.
#[derive(Debug, Clone, Copy)]
pub struct Grading {
    /// Columns from this abscissa on have width h; 2 h for 6 mm before it, 4 h before that. m.
    pub fine_from: f64,
    /// Rows up to this distance from the crack have height h; 2 h for 2 mm beyond it, 4 h beyond that. m.
    pub fine_to: f64,
}

impl Mesh {
    /// The upper half of the plate, or all of it, with element size `h` (m).
    pub fn plate(h: f64, grading: Option<Grading>, whole: bool) -> Self {
        let (mut x, mut y) = (vec![0.0], vec![0.0]);
        match grading {
            None => {
                extend(&mut x, LENGTH, h);
                extend(&mut y, HALF_HEIGHT, h);
            }
            Some(Grading { fine_from, fine_to }) => {
                extend(&mut x, fine_from - 6e-3, 4.0 * h);
                extend(&mut x, fine_from, 2.0 * h);
                extend(&mut x, LENGTH, h);
                extend(&mut y, fine_to, h);
                extend(&mut y, fine_to + 2e-3, 2.0 * h);
                extend(&mut y, HALF_HEIGHT, 4.0 * h);
            }
        }
        if whole {
            y = y.iter().skip(1).rev().map(|y| -y).chain(y.iter().copied()).collect();
        }
        Self { x, y }
    }

    /// A strip of the given size with square elements, for the closed forms.
    pub fn strip(length: f64, height: f64, h: f64) -> Self {
        let (mut x, mut y) = (vec![0.0], vec![0.0]);
        extend(&mut x, length, h);
        extend(&mut y, height, h);
        Self { x, y }
    }

    /// Elements per row.
    pub fn columns(&self) -> usize {
        self.x.len() - 1
    }

    /// Rows of elements.
    pub fn rows(&self) -> usize {
        self.y.len() - 1
    }

    /// Numbers in a row of an array of nodal values: the nodes and a guard on either side.
    pub fn stride(&self) -> usize {
        self.x.len() + 2
    }

    /// An array of nodal values, row by row; guards and nodes are zero.
    pub fn nodal(&self) -> Vec<f64> {
        vec![0.0; self.stride() * self.y.len()]
    }

    /// Widths of the elements of a row at 1, 2, …; the guards are 1.
    pub fn widths(&self) -> Vec<f64> {
        let mut widths = vec![1.0; self.stride()];
        for (i, ends) in self.x.windows(2).enumerate() {
            widths[i + 1] = ends[1] - ends[0];
        }
        widths
    }

    /// Heights of the rows.
    pub fn heights(&self) -> Vec<f64> {
        self.y.windows(2).map(|ends| ends[1] - ends[0]).collect()
    }

    /// Lumped volumes of the nodes, m² (per metre of thickness).
    pub fn volumes(&self) -> Vec<f64> {
        let mut volumes = self.nodal();
        let share = |lines: &[f64], k: usize| {
            let before = if k > 0 { lines[k] - lines[k - 1] } else { 0.0 };
            0.5 * (before + lines.get(k + 1).map_or(0.0, |next| next - lines[k]))
        };
        for (j, row) in volumes.chunks_exact_mut(self.stride()).enumerate() {
            for (i, volume) in row[1..=self.x.len()].iter_mut().enumerate() {
                *volume = share(&self.x, i) * share(&self.y, j);
            }
        }
        volumes
    }

    /// Shortest side of an element, m.
    pub fn smallest(&self) -> f64 {
        let sides = |lines: &[f64]| lines.windows(2).map(|ends| ends[1] - ends[0]).fold(f64::INFINITY, f64::min);
        sides(&self.x).min(sides(&self.y))
    }
}

/// Continues node lines to `end` in equal spans of about `h`.
pub fn extend(lines: &mut Vec<f64>, end: f64, h: f64) {
    let start = lines.last().copied().unwrap_or(0.0);
    let spans = ((end - start) / h).round().max(1.0) as usize;
    lines.extend((1..=spans).map(|k| start + (end - start) * k as f64 / spans as f64));
}
