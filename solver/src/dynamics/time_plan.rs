//! Time steps and samples: a sample interval is a whole number of equal steps.

use crate::contact::motion::{MOST, longest_step};
use crate::linear_algebra::extremes::smaller;
use crate::scene::{Analysis, Output, Scene, TimeStep};

/// Fraction of the longest step of bodies that meet that is taken: speeds change.
const SPARE: f64 = 0.8;
/// Relative round-off of numbers of steps.
const ROUND_OFF: f64 = 1e-12;
/// Part by which a given step may be shortened without a word.
const TOLERATED: f64 = 1e-6;

/// Steps and samples of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimePlan {
    /// Length of a planned time step, s.
    pub step: f64,
    /// Steps between samples.
    pub steps_per_sample: usize,
    /// Samples after the first.
    pub samples: usize,
    /// Critical step of the operator, s.
    pub critical: f64,
}

impl TimePlan {
    /// Plan for a scene whose operator has the critical step `critical` (s), with warnings for people.
    pub fn new(scene: &Scene, critical: f64) -> (Self, Vec<String>) {
        Self::within(&scene.analysis, &scene.output, critical, longest_step(scene))
    }

    /// Plan for a critical step and the longest step (s) in which contact can follow bodies that meet.
    fn within(analysis: &Analysis, output: &Output, critical: f64, passing: f64) -> (Self, Vec<String>) {
        let mut warnings = Vec::new();
        let end = analysis.end_time;
        let stable = fault!("safety-ignored", analysis.safety => 1.0) * critical;
        let longest = match analysis.time_step {
            TimeStep::Auto => smaller(smaller(stable, SPARE * passing), end),
            TimeStep::Fixed(step) => smaller(step, end),
        };
        if analysis.time_step == TimeStep::Auto && longest < stable.min(end) {
            warnings.push(format!(
                "bodies approach each other so fast that the time step is {longest:.4e} s instead of {stable:.4e} s: \
                 contact follows {MOST} spans in a step, and less of thin bodies"
            ));
        }
        let mut samples = output.samples.max(1);
        if end / (samples as f64) < 0.5 * longest {
            let asked = samples;
            samples = whole(end / longest); // of a step each: one less would make it two
            warnings.push(format!(
                "{asked} samples would shorten the time step of {longest:.4e} s more than twofold; the number of samples is {samples}"
            ));
        }
        let interval = end / samples as f64;
        let steps_per_sample = whole(interval / longest);
        let step = interval / steps_per_sample as f64;
        if let TimeStep::Fixed(asked) = analysis.time_step
            && step < asked * (1.0 - TOLERATED)
        {
            warnings.push(format!(
                "the time step is {step:.6e} s instead of {asked:.6e} s, so that each of {samples} samples falls on a \
                 step: {steps_per_sample} to a sample"
            ));
        }
        if step > critical {
            warnings.push(format!(
                "the time step {step:.4e} s is {:.3} times the critical step {critical:.4e} s of the undamaged body: \
                 expect the run to break down, or set time_step = \"auto\"",
                step / critical
            ));
        }
        if step > passing {
            warnings.push(format!(
                "in the time step {step:.4e} s bodies approach each other by more than {MOST} spans: the run ends where \
                 they meet; give {:.4e} s or less, or time_step = \"auto\"",
                SPARE * passing
            ));
        }
        (Self { step, steps_per_sample, samples, critical }, warnings)
    }

    /// Number of planned steps from t = 0 to the end of the run.
    pub fn steps(&self) -> usize {
        self.samples.saturating_mul(self.steps_per_sample)
    }
}

/// The least number of steps that is not below a ratio, to round-off; at least one.
fn whole(ratio: f64) -> usize {
    (ratio * (1.0 - ROUND_OFF)).ceil().max(1.0) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::example::elastic_scene;

    fn plan(end_time: f64, time_step: TimeStep, samples: usize, critical: f64) -> (TimePlan, Vec<String>) {
        plan_within(end_time, time_step, samples, critical, f64::INFINITY)
    }

    fn plan_within(
        end_time: f64,
        time_step: TimeStep,
        samples: usize,
        critical: f64,
        passing: f64,
    ) -> (TimePlan, Vec<String>) {
        let analysis = Analysis { end_time, time_step, ..elastic_scene(1, [1.0; 2], [1; 2]).analysis };
        TimePlan::within(&analysis, &Output::rows(samples), critical, passing)
    }

    #[test]
    fn samples_fall_on_whole_steps_and_the_step_is_never_longer_than_allowed() {
        let (plan, warnings) = plan(1.0, TimeStep::Auto, 7, 0.03);
        assert!(warnings.is_empty());
        assert!(plan.step <= 0.8 * 0.03 && plan.step > 0.5 * 0.8 * 0.03);
        approx::assert_relative_eq!(plan.step * plan.steps() as f64, 1.0, epsilon = 1e-14);
    }

    #[test]
    fn more_samples_than_steps_give_fewer_rows_and_a_warning() {
        let (plan, warnings) = plan(1.0, TimeStep::Auto, 1000, 0.1);
        assert_eq!(warnings.len(), 1, "{warnings:?}");
        assert_eq!((plan.samples, plan.steps_per_sample), (13, 1), "12.5 steps of 0.08 s are 13, not 24");
    }

    #[test]
    fn a_step_that_is_changed_is_reported() {
        let told = |step, samples| plan(1e-5, step, samples, 1e-7).1;
        assert!(told(TimeStep::Fixed(5e-8), 200).is_empty(), "200 steps in 200 samples");
        assert!(told(TimeStep::Fixed(5e-8), 100).is_empty(), "2 to each of 100 samples");
        let changed = told(TimeStep::Fixed(7e-8), 200);
        assert!(changed[0].contains("5.000000e-8 s instead of 7.000000e-8 s"), "{changed:?}");
        let fewer = told(TimeStep::Fixed(7e-8), 320);
        assert!(
            fewer[0].contains("the number of samples is 143") && fewer[1].contains("6.993007e-8 s instead of"),
            "{fewer:?}"
        );
        assert_eq!(told(TimeStep::Fixed(1.0), 1).len(), 2, "beyond the end, and critical");
        assert!(told(TimeStep::Auto, 50).is_empty() && told(TimeStep::Auto, 120).is_empty());
    }

    #[test]
    fn bodies_that_would_pass_each_other_shorten_the_step_or_warn() {
        let (plan, warnings) = plan_within(1.0, TimeStep::Auto, 7, 0.03, 0.01);
        assert!(plan.step <= 0.8 * 0.01 && plan.step > 0.7 * 0.8 * 0.01, "{plan:?}");
        assert!(warnings.len() == 1 && warnings[0].contains("contact follows 0.5 spans"), "{warnings:?}");
        assert!(plan_within(1.0, TimeStep::Auto, 7, 0.03, 0.03).1.is_empty());
        let (plan, warnings) = plan_within(1.0, TimeStep::Fixed(0.02), 5, 0.1, 0.01);
        assert_eq!(plan.steps(), 50);
        assert!(warnings.len() == 1 && warnings[0].contains("8.0000e-3 s or less"), "{warnings:?}");
    }

    #[test]
    fn a_step_beyond_the_critical_one_warns() {
        let (plan, warnings) = plan(1.0, TimeStep::Fixed(0.2), 5, 0.1);
        assert_eq!(plan.steps(), 5);
        assert!(warnings[0].contains("2.000 times the critical step"), "{warnings:?}");
    }
}
