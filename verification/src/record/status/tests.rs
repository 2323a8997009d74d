use super::*;

fn both(min: f64, max: f64) -> Accept {
    Accept { min: Some(min), max: Some(max), ..Accept::default() }
}

fn reference(value: f64, uncertainty: Option<f64>) -> Option<Reference> {
    Some(Reference { value: Some(value), uncertainty, ..Reference::default() })
}

fn limit(min: f64, max: f64) -> Option<Limit> {
    Some(Limit { min: Some(min), max: Some(max), why: "a cause".into(), regression: false })
}

fn decided(mut record: Record) -> Status {
    record.decide();
    record.status
}

/// `compare` asks a stored record, which has its reference already.
#[test]
fn a_regression_bound_decides_again_as_it_did() {
    let accept = Accept { max: Some(0.2), regression: true, ..Accept::default() };
    let mut record = Record { value: Some(0.1), unit: "1".into(), accept, ..Record::default() };
    for _ in 0..2 {
        record.decide();
        assert_eq!(record.status, Status::Pass);
    }
}

#[test]
fn more_than_a_twentieth_of_the_reference_is_no_agreement() {
    let held = |accept: Accept, uncertainty, limit| {
        let reference = reference(2.0, uncertainty);
        decided(Record { value: Some(2.05), reference, accept, limit, ..Record::default() })
    };
    assert_eq!(held(both(1.9, 2.1), None, None), Status::Pass);
    assert_eq!(held(both(1.9, 2.2), None, None), Status::Info);
    assert_eq!(held(Accept { min: Some(1.9), ..Accept::default() }, None, None), Status::Info);
    assert_eq!(held(Accept::default(), Some(0.09), None), Status::Pass);
    assert_eq!(held(Accept::default(), Some(0.2), None), Status::Info);
    assert_eq!(held(Accept::default(), Some(0.2), limit(2.0, 2.5)), Status::Info);
    assert_eq!(held(Accept::default(), Some(0.2), limit(2.2, 2.5)), Status::Info);
    assert_eq!(held(both(1.8, 2.04), None, None), Status::Fail, "outside is no agreement, however wide");
    assert_eq!(held(both(1.8, 2.04), None, limit(2.04, 2.5)), Status::KnownLimit);
    let missing = Record { reference: reference(2.0, Some(0.2)), ..Record::default() };
    assert_eq!(decided(missing), Status::Fail);
    let of_zero =
        Record { value: Some(0.1), reference: reference(0.0, None), accept: both(0.0, 0.2), ..Record::default() };
    assert_eq!(decided(of_zero), Status::Pass, "a fraction of zero says nothing");
}

#[test]
fn a_lower_or_upper_bound_is_met_on_its_side() {
    let held = |side, value: f64, accept: Accept| {
        let reference = Some(Reference { side, ..Reference::new(Some(3.0), ReferenceKind::Theory, "p + 1") });
        decided(Record { value: Some(value), reference, accept, ..Record::default() })
    };
    let order = both(2.9, 3.5);
    assert_eq!(held(Side::AtLeast, 3.3, order.clone()), Status::Pass);
    assert_eq!(held(Side::AtLeast, 3.6, order.clone()), Status::Fail);
    assert_eq!(held(Side::AtLeast, 2.8, order.clone()), Status::Fail);
    assert_eq!(held(Side::Both, 3.3, order), Status::Info);
    assert_eq!(held(Side::AtMost, 2.0, both(0.0, 3.1)), Status::Pass);
    assert_eq!(held(Side::AtMost, 2.0, both(0.0, 3.4)), Status::Info);
}

#[test]
fn a_bound_chosen_after_the_result_is_one_of_regression() {
    let of = |reference, regression, max| {
        let accept = Accept { max, regression, ..Accept::default() };
        let mut record = Record { value: Some(1.0), reference, accept, ..Record::default() };
        record.decide();
        record
    };
    let record = of(None, true, Some(2.0));
    assert!(record.is_regression() && record.reference.unwrap().kind == ReferenceKind::Regression);
    assert!(!of(None, true, None).is_regression(), "without bounds");
    assert!(!of(None, false, Some(2.0)).is_regression());
}
