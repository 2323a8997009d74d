//! Eight neighbouring spans side by side: the vector type of the hot loops, and the one place where wider
//! instructions are switched on.
//!
//! Every loop over [`Lane`] is plain arithmetic on eight numbers, which the compiler turns into vector
//! instructions of whatever width the surrounding function may use. [`dispatch`] enters a function compiled
//! for AVX2 and FMA, or for AVX-512, where the processor has them, so a default build needs no compiler
//! flags.

use serde::{Deserialize, Serialize};
use std::ops::{Add, AddAssign, Index, IndexMut, Mul, Neg, Sub};

/// Spans handled together.
pub const LANES: usize = 8;

/// Numbers of single or double precision.
pub trait Scalar:
    Copy
    + Default
    + PartialOrd
    + Send
    + Sync
    + Into<f64>
    + From<f32>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Neg<Output = Self>
{
    /// The number zero in this precision.
    const ZERO: Self;
    /// The nearest number of this precision.
    fn of(value: f64) -> Self;
    /// `self a + b` with one rounding.
    fn fused(self, a: Self, b: Self) -> Self;
}

macro_rules! scalar {
    ($($type:ty),+) => {$(
        impl Scalar for $type {
            const ZERO: Self = 0.0;
            #[inline(always)]
            fn of(value: f64) -> Self {
                value as Self
            }
            #[inline(always)]
            fn fused(self, a: Self, b: Self) -> Self {
                self.mul_add(a, b)
            }
        }
    )+};
}
scalar!(f32, f64);

/// One number for each of [`LANES`] neighbouring spans.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[repr(C, align(64))]
pub struct Lane<T = f64>(pub [T; LANES]);

impl<T: Scalar> Lane<T> {
    /// The number zero in every lane.
    pub const ZERO: Self = Self([T::ZERO; LANES]);

    /// The same number in every lane.
    #[inline(always)]
    pub fn splat(value: T) -> Self {
        Self([value; LANES])
    }

    /// Reads eight neighbours.
    #[inline(always)]
    pub fn load(values: &[T], at: usize) -> Self {
        let mut lane = Self::ZERO;
        lane.0.copy_from_slice(&values[at..at + LANES]);
        lane
    }

    /// Reads eight neighbours of any precision.
    #[inline(always)]
    pub(crate) fn load_from<C: Copy>(values: &[C], at: usize) -> Self
    where
        T: From<C>,
    {
        let mut lane = Self::ZERO;
        for (lane, value) in lane.0.iter_mut().zip(&values[at..at + LANES]) {
            *lane = T::from(*value);
        }
        lane
    }

    /// Adds to eight neighbours.
    #[inline(always)]
    pub fn add_to(self, values: &mut [T], at: usize) {
        for (value, add) in values[at..at + LANES].iter_mut().zip(self.0) {
            *value = *value + add;
        }
    }

    /// Applies `f` to the number in each lane.
    #[inline(always)]
    pub fn map(self, f: impl Fn(T) -> T) -> Self {
        let mut out = Self::ZERO;
        for l in 0..LANES {
            out.0[l] = f(self.0[l]);
        }
        out
    }

    /// `f` of each pair of lanes.
    #[inline(always)]
    pub fn zip(self, other: Self, f: impl Fn(T, T) -> T) -> Self {
        let mut out = Self::ZERO;
        for l in 0..LANES {
            out.0[l] = f(self.0[l], other.0[l]);
        }
        out
    }

    /// `self + a b`, with one rounding if `FMA`.
    #[inline(always)]
    pub fn add_product<const FMA: bool>(self, a: Self, b: Self) -> Self {
        let mut out = self;
        for l in 0..LANES {
            out.0[l] = add_product::<FMA, _>(out.0[l], a.0[l], b.0[l]);
        }
        out
    }

    /// `self + a b` with the same `b` in every lane.
    #[inline(always)]
    pub(crate) fn add_scaled<const FMA: bool>(self, a: Self, b: T) -> Self {
        self.add_product::<FMA>(a, Self::splat(b))
    }

    /// The larger one of each lane and its floor. A lane that is not a number stays one, which costs nothing:
    /// the vector instruction takes its second operand unless the first is larger. A floor that is not a
    /// number is lost.
    #[inline(always)]
    pub fn at_least(self, floor: Self) -> Self {
        floor.zip(self, |floor, value| if floor > value { floor } else { value })
    }

    /// The smaller one of each lane and its ceiling; what is not a number as in [`Self::at_least`].
    #[inline(always)]
    pub fn at_most(self, ceiling: Self) -> Self {
        ceiling.zip(self, |ceiling, value| if ceiling < value { ceiling } else { value })
    }

    /// Sum over the lanes, always in the same order.
    #[inline(always)]
    pub fn sum(self) -> T {
        let v = self.0;
        ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]))
    }
}

/// `sum + a b`, with one rounding if `FMA`.
#[inline(always)]
pub fn add_product<const FMA: bool, T: Scalar>(sum: T, a: T, b: T) -> T {
    if FMA { a.fused(b, sum) } else { sum + a * b }
}

impl<T> Index<usize> for Lane<T> {
    type Output = T;
    #[inline(always)]
    fn index(&self, lane: usize) -> &T {
        &self.0[lane]
    }
}

impl<T> IndexMut<usize> for Lane<T> {
    #[inline(always)]
    fn index_mut(&mut self, lane: usize) -> &mut T {
        &mut self.0[lane]
    }
}

macro_rules! lanewise {
    ($trait:ident, $method:ident, $op:tt) => {
        impl<T: Scalar> $trait for Lane<T> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.zip(other, |a, b| a $op b)
            }
        }
        impl<T: Scalar> $trait<T> for Lane<T> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: T) -> Self {
                self.map(|a| a $op other)
            }
        }
    };
}
lanewise!(Add, add, +);
lanewise!(Sub, sub, -);
lanewise!(Mul, mul, *);

impl<T: Scalar> AddAssign for Lane<T> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

/// An array of values by index, as part of its caller: `array::map` may stay a function of its own, which is
/// compiled without the vector instructions of a caller within [`dispatch`].
macro_rules! each {
    ($index:ident in [$($number:literal),+] => $value:expr) => {
        [$({ let $index: usize = $number; $value }),+]
    };
}
pub(crate) use each;

/// Asks the processor to fetch a value that will be read soon, if there is one: sweeps walk down columns of
/// spans, which no hardware foresees.
#[inline(always)]
pub(crate) fn prefetch<T>(values: &[T], at: usize) {
    #[cfg(target_arch = "x86_64")]
    if let Some(value) = values.get(at) {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: a hint that changes nothing, at an address within a slice.
        #[expect(unsafe_code, reason = "hints to the processor take a pointer")]
        unsafe {
            _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(value).cast());
        }
    }
}

/// Work to be compiled for wide vector instructions and without.
pub trait Vectorised {
    /// What the work gives back.
    type Output;
    /// Whether it is also compiled for AVX-512, where the processor has that. It gives the same bits, takes
    /// long to compile, and only sweeps with much arithmetic per number gain from it.
    const WIDEST: bool = false;
    /// The work; implementations are `#[inline(always)]` so that they take on the instructions of their
    /// caller.
    fn run<const FMA: bool>(self) -> Self::Output;
}

/// Runs `work` with the widest instructions this processor has.
pub fn dispatch<W: Vectorised>(work: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    {
        #[target_feature(enable = "avx512f,avx512dq,avx512vl,fma")]
        fn widest<W: Vectorised>(work: W) -> W::Output {
            work.run::<true>()
        }
        #[target_feature(enable = "avx2,fma")]
        fn wide<W: Vectorised>(work: W) -> W::Output {
            work.run::<true>()
        }
        let has_avx2 = std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma");
        if W::WIDEST
            && has_avx2
            && std::is_x86_feature_detected!("avx512f")
            && std::is_x86_feature_detected!("avx512dq")
            && std::is_x86_feature_detected!("avx512vl")
        {
            // SAFETY: the processor was just asked for these features.
            #[expect(unsafe_code, reason = "the caller of a function compiled for more features must have them")]
            return unsafe { widest(work) };
        }
        if has_avx2 {
            // SAFETY: the processor was just asked for both features.
            #[expect(unsafe_code, reason = "the caller of a function compiled for more features must have them")]
            return unsafe { wide(work) };
        }
    }
    work.run::<false>()
}
