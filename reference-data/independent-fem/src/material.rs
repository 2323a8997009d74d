//! Linear elasticity with the spectral split of Miehe et al., degraded by an AT2 or AT1 phase field; l0 is
//! the length scale of Borden et al. (2012), b = 2 l0 that of the AT1 literature.

/// Energy of a crack per area, over Gc.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Surface {
    /// (1 − c)²/(4 l0) + l0 |grad c|², driven by the largest tensile energy so far.
    At2,
    /// 3/8 [(1 − c)/b + b |grad c|²], driven by the present tensile energy; c never rises.
    At1,
}

/// What the plate is made of, SI units.
#[derive(Debug, Clone, Copy)]
pub struct Material {
    /// First Lamé constant; in plane stress the one of the in-plane tensor. Pa.
    pub lambda: f64,
    /// Shear modulus, Pa.
    pub mu: f64,
    /// Density, kg/m³.
    pub density: f64,
    /// Critical energy release rate Gc, J/m².
    pub toughness: f64,
    /// Length scale l0 of Borden et al. (2012), m.
    pub length_scale: f64,
    /// Residual stiffness k.
    pub residual: f64,
    /// Energy of a crack.
    pub surface: Surface,
}

impl Material {
    /// From Young's modulus (Pa) and Poisson's ratio.
    pub fn new(young: f64, poisson: f64, plane_stress: bool) -> Self {
        let mu = young / (2.0 * (1.0 + poisson));
        let lambda = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
        let lambda = if plane_stress { 2.0 * lambda * mu / (lambda + 2.0 * mu) } else { lambda };
        Self {
            lambda,
            mu,
            density: 2450.0,
            toughness: 3.0,
            length_scale: 0.25e-3,
            residual: 0.0,
            surface: Surface::At2,
        }
    }

    /// Speed of dilatational waves, m/s.
    pub fn wave_speed(&self) -> f64 {
        ((self.lambda + 2.0 * self.mu) / self.density).sqrt()
    }

    /// Critical step of a bilinear element with the shortest side `h` (m) and lumped mass, s.
    pub fn critical_step(&self, h: f64) -> f64 {
        h * (self.density / (2.0 * (self.lambda + self.mu))).sqrt()
    }

    /// Tensile energy psi+ of strains exx, eyy and the engineering shear gxy, J/m³.
    #[inline(always)]
    pub fn tensile_energy(&self, [exx, eyy, gxy]: [f64; 3]) -> f64 {
        let (trace, [first, second]) = principal(exx, eyy, gxy);
        let (trace, first, second) = (positive(trace), positive(first), positive(second));
        0.5 * self.lambda * trace * trace + self.mu * (first * first + second * second)
    }

    /// Compressive energy psi−, J/m³.
    pub fn compressive_energy(&self, [exx, eyy, gxy]: [f64; 3]) -> f64 {
        self.tensile_energy([-exx, -eyy, -gxy])
    }

    /// Energy of a crack per volume where the square of the slope of c is `slope`, J/m³.
    pub fn crack_density(&self, c: f64, slope: f64) -> f64 {
        let (l0, b) = (self.length_scale, 2.0 * self.length_scale);
        self.toughness
            * match self.surface {
                Surface::At2 => (1.0 - c) * (1.0 - c) / (4.0 * l0) + l0 * slope,
                Surface::At1 => 0.375 * ((1.0 - c) / b + b * slope),
            }
    }

    /// Local term, factor of the driving energy H and diffusion of the equation
    /// `(local + factor H) c − diffusion div grad c = 1`.
    pub fn crack_equation(&self) -> [f64; 3] {
        let (l0, b) = (self.length_scale, 2.0 * self.length_scale);
        let drive = (1.0 - self.residual) / self.toughness;
        match self.surface {
            Surface::At2 => [1.0, 4.0 * l0 * drive, 4.0 * l0 * l0],
            Surface::At1 => [0.0, 16.0 / 3.0 * b * drive, 2.0 * b * b],
        }
    }

    /// g(c) = (1 − k) c² + k.
    #[inline(always)]
    pub fn degradation(&self, c: f64) -> f64 {
        (1.0 - self.residual) * c * c + self.residual
    }

    /// Stresses sxx, syy, sxy at the degradation `g`, Pa.
    #[inline(always)]
    pub fn stress(&self, [exx, eyy, gxy]: [f64; 3], g: f64) -> [f64; 3] {
        let (mean, half, shear) = (0.5 * (exx + eyy), 0.5 * (exx - eyy), 0.5 * gxy);
        let radius = (half * half + shear * shear).sqrt();
        let (first, second) = (positive(mean + radius), positive(mean - radius));
        // positive part of the strain: a I + b (e − mean I)
        let a = 0.5 * (first + second);
        let b = 0.5 * (first - second) / larger(radius, 1e-300);
        let loss = g - 1.0;
        let trace = exx + eyy;
        let volumetric = self.lambda * (if trace > 0.0 { g * trace } else { trace });
        let twice = 2.0 * self.mu;
        [
            volumetric + twice * (exx + loss * (a + b * half)),
            volumetric + twice * (eyy + loss * (a - b * half)),
            twice * (shear + loss * b * shear),
        ]
    }
}

/// Trace and principal values of a strain.
#[inline(always)]
fn principal(exx: f64, eyy: f64, gxy: f64) -> (f64, [f64; 2]) {
    let (mean, half, shear) = (0.5 * (exx + eyy), 0.5 * (exx - eyy), 0.5 * gxy);
    let radius = (half * half + shear * shear).sqrt();
    (exx + eyy, [mean + radius, mean - radius])
}

/// The larger of two numbers as one instruction; the second if the first is not a number.
#[inline(always)]
pub fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

#[inline(always)]
fn positive(value: f64) -> f64 {
    larger(value, 0.0)
}
