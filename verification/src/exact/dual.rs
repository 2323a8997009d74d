//! Numbers that carry their derivatives with respect to x, y and t (forward differentiation).
//!
//! A [`Dual`] is a value with its gradient, and the rules of calculus are its arithmetic. Nested once, in a
//! [`Jet`], the entries of the gradient carry their own gradients, which are the second derivatives:
//!
//! ```
//! use fisura_verification::exact::dual::{Jet, Scalar};
//!
//! let [x, y, _] = Jet::variables([0.5, 2.0], 0.0);
//! let u = (x * y).sin();
//! assert_eq!(u.gradient[0].value, 2.0 * 1f64.cos());
//! assert_eq!(u.gradient[0].gradient[1], 1f64.cos() - 1f64.sin());
//! ```
//!
//! Derivatives come out to round-off, because nothing is differenced.

use std::array::from_fn;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Directions of differentiation: x, y, t.
pub const DIRECTIONS: usize = 3;

/// What the formulas of exact solutions are made of: plain numbers, or numbers with derivatives.
pub trait Scalar:
    Copy
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
{
    /// A number that does not vary.
    fn constant(value: f64) -> Self;
    /// Sine and cosine of an angle, rad, in this order.
    fn sin_cos(self) -> (Self, Self);
    /// Sine of an angle, rad.
    fn sin(self) -> Self {
        self.sin_cos().0
    }
    /// Cosine of an angle, rad.
    fn cos(self) -> Self {
        self.sin_cos().1
    }
    /// Exponential function.
    fn exp(self) -> Self;
    /// Natural logarithm of a positive number.
    fn ln(self) -> Self;
    /// Square root of a positive number.
    fn sqrt(self) -> Self;
}

impl Scalar for f64 {
    fn constant(value: f64) -> Self {
        value
    }
    fn sin_cos(self) -> (Self, Self) {
        f64::sin_cos(self)
    }
    fn exp(self) -> Self {
        f64::exp(self)
    }
    fn ln(self) -> Self {
        f64::ln(self)
    }
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
}

/// A value and its derivatives with respect to x, y, t.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual<T> {
    /// Value at the position and time.
    pub value: T,
    /// `∂/∂x, ∂/∂y, ∂/∂t`.
    pub gradient: [T; DIRECTIONS],
}

/// A number with its first derivatives.
pub type Field = Dual<f64>;

/// A number with its first and second derivatives: `gradient[i].gradient[j]` is `∂²/∂i∂j`.
pub type Jet = Dual<Field>;

impl Field {
    /// x (m), y (m) and t (s) as the variables of differentiation.
    pub fn variables([x, y]: [f64; 2], t: f64) -> [Self; DIRECTIONS] {
        from_fn(|d| Self { value: [x, y, t][d], gradient: from_fn(|i| f64::from(i == d)) })
    }
}

impl Jet {
    /// x (m), y (m) and t (s) as the variables of differentiation.
    pub fn variables(position: [f64; 2], t: f64) -> [Self; DIRECTIONS] {
        Field::variables(position, t).map(|value| Self { value, gradient: value.gradient.map(Field::constant) })
    }
}

impl<T: Scalar> Dual<T> {
    /// The chain rule: a function of this number, given its value and its slope here.
    #[inline]
    pub fn chain(self, value: T, slope: T) -> Self {
        let [x, y, t] = self.gradient;
        Self { value, gradient: [slope * x, slope * y, slope * t] }
    }

    /// The chain rule for a function of two numbers, given its value and both slopes.
    #[inline]
    fn chain_two(self, other: Self, value: T, slopes: [T; 2]) -> Self {
        let along = |d: usize| slopes[0] * self.gradient[d] + slopes[1] * other.gradient[d];
        Self { value, gradient: [along(0), along(1), along(2)] }
    }
}

impl<T: Scalar> Scalar for Dual<T> {
    fn constant(value: f64) -> Self {
        Self { value: T::constant(value), gradient: [T::constant(0.0); DIRECTIONS] }
    }
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        (self.chain(sin, cos), self.chain(cos, -sin))
    }
    fn exp(self) -> Self {
        let value = self.value.exp();
        self.chain(value, value)
    }
    fn ln(self) -> Self {
        self.chain(self.value.ln(), T::constant(1.0) / self.value)
    }
    fn sqrt(self) -> Self {
        let value = self.value.sqrt();
        self.chain(value, T::constant(0.5) / value)
    }
}

impl<T: Scalar> Neg for Dual<T> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        let [x, y, t] = self.gradient;
        Self { value: -self.value, gradient: [-x, -y, -t] }
    }
}

/// Operators with this number on the left.
macro_rules! operators {
    ($($operator:ident::$apply:ident($left:ident, $right:ident: $kind:ty) $result:block)+) => {
        $(impl<T: Scalar> $operator<$kind> for Dual<T> {
            type Output = Self;
            #[inline]
            fn $apply(self, $right: $kind) -> Self {
                let $left = self;
                $result
            }
        })+
    };
}

operators! {
    Add::add(a, b: Self) {
        let ([x, y, t], [bx, by, bt]) = (a.gradient, b.gradient);
        Self { value: a.value + b.value, gradient: [x + bx, y + by, t + bt] }
    }
    Sub::sub(a, b: Self) { a + -b }
    Mul::mul(a, b: Self) { a.chain_two(b, a.value * b.value, [b.value, a.value]) }
    Div::div(a, b: Self) {
        let value = a.value / b.value;
        a.chain_two(b, value, [T::constant(1.0) / b.value, -value / b.value])
    }
    Add::add(a, b: f64) { Self { value: a.value + b, ..a } }
    Sub::sub(a, b: f64) { a + -b }
    Mul::mul(a, b: f64) {
        let [x, y, t] = a.gradient;
        Self { value: a.value * b, gradient: [x * b, y * b, t * b] }
    }
}
