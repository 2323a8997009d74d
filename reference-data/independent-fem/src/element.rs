//! Bilinear rectangles with 2 × 2 Gauss points: interpolation, strains and what they give to the corners.

/// Abscissa of the lower Gauss point on the unit interval.
pub const LOW: f64 = 0.211_324_865_405_187_1;
/// Abscissa of the upper one.
pub const HIGH: f64 = 1.0 - LOW;

/// Values at the corners of an element: lower left, lower right, upper left, upper right.
pub type Corners = [f64; 4];

/// Values at the Gauss points of an element: y low (x low, x high), y high (x low, x high).
pub type Gauss<T> = [T; 4];

/// Values at the Gauss points.
#[inline(always)]
pub fn interpolate([ll, lr, ul, ur]: Corners) -> Gauss<f64> {
    let (l_low, r_low) = (HIGH * ll + LOW * ul, HIGH * lr + LOW * ur);
    let (l_high, r_high) = (LOW * ll + HIGH * ul, LOW * lr + HIGH * ur);
    [HIGH * l_low + LOW * r_low, LOW * l_low + HIGH * r_low, HIGH * l_high + LOW * r_high, LOW * l_high + HIGH * r_high]
}

/// Derivatives of corner values: along x at y low and high, along y at x low and high; per unit of the
/// inverse sides.
#[inline(always)]
pub fn slopes([ll, lr, ul, ur]: Corners, inverse_width: f64, inverse_height: f64) -> ([f64; 2], [f64; 2]) {
    let (below, above) = ((lr - ll) * inverse_width, (ur - ul) * inverse_width);
    let (left, right) = ((ul - ll) * inverse_height, (ur - lr) * inverse_height);
    ([HIGH * below + LOW * above, LOW * below + HIGH * above], [HIGH * left + LOW * right, LOW * left + HIGH * right])
}

/// Strains exx, eyy and engineering shear gxy at the Gauss points.
#[inline(always)]
pub fn strains(ux: Corners, uy: Corners, inverse_width: f64, inverse_height: f64) -> Gauss<[f64; 3]> {
    let (ux_x, ux_y) = slopes(ux, inverse_width, inverse_height);
    let (uy_x, uy_y) = slopes(uy, inverse_width, inverse_height);
    [
        [ux_x[0], uy_y[0], ux_y[0] + uy_x[0]],
        [ux_x[0], uy_y[1], ux_y[1] + uy_x[0]],
        [ux_x[1], uy_y[0], ux_y[0] + uy_x[1]],
        [ux_x[1], uy_y[1], ux_y[1] + uy_x[1]],
    ]
}

/// Forces −∫ B^T sigma at the corners, along x and along y, of stresses sxx, syy, sxy at the Gauss points.
#[inline(always)]
pub fn forces(stress: Gauss<[f64; 3]>, width: f64, height: f64) -> (Corners, Corners) {
    let [p, q, r, s] = stress;
    let (over_x, over_y) = (0.25 * height, 0.25 * width);
    // sums along a line of Gauss points: sxx and sxy over x at either y; sxy and syy over y at either x
    let (xx, xy) = ([p[0] + q[0], r[0] + s[0]], [p[2] + q[2], r[2] + s[2]]);
    let (yx, yy) = ([p[2] + r[2], q[2] + s[2]], [p[1] + r[1], q[1] + s[1]]);
    (spread(xx, yx, over_x, over_y), spread(xy, yy, over_x, over_y))
}

/// Corner forces of a stress component along x (`along`, at y low and high) and one along y (`across`, at x
/// low and high).
#[inline(always)]
fn spread(along: [f64; 2], across: [f64; 2], over_x: f64, over_y: f64) -> Corners {
    let (x_low, x_high) = (over_x * (HIGH * along[0] + LOW * along[1]), over_x * (LOW * along[0] + HIGH * along[1]));
    let (y_low, y_high) =
        (over_y * (HIGH * across[0] + LOW * across[1]), over_y * (LOW * across[0] + HIGH * across[1]));
    [x_low + y_low, -x_low + y_high, x_high - y_low, -x_high - y_high]
}
