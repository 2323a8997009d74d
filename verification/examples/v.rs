//! scratch
use fisura_verification::{record::*, suite::*};
use std::path::Path;
struct P;
impl Progress for P {
    fn started(&self, c: &Case, _i: usize, _n: usize) {
        eprintln!("> {}", c.id());
    }
    fn advanced(&self, _: f64) {}
    fn finished(&self, _c: &Case, r: &[Record]) {
        for r in r {
            eprintln!(
                "  {:?} {} = {:?} {} [{:?},{:?}] {}",
                r.status,
                r.id,
                r.value,
                r.unit,
                r.accept.min,
                r.accept.max,
                r.message.clone().unwrap_or_default()
            );
        }
        if let Some(r) = r.first() {
            eprintln!("  wall {:.1}", r.timing.wall_s)
        }
    }
}
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let cases = load_cases(Path::new("verification/cases"), &[]).unwrap_or_else(|e| {
        eprintln!("{e}");
        std::process::exit(2)
    });
    let sel = Selection { suites: vec![], case_glob: Some(a[1].clone()), tier: Tier::Full };
    let cs = select(cases, &sel);
    let o = Options {
        out: Path::new(&a[2]),
        reference_data: Path::new("reference-data"),
        environment: Environment::default(),
        resume: false,
    };
    if let Err(e) = verify(&cs, &o, &P) {
        eprintln!("{e}");
    }
}
