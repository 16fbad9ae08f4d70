//! An answer of a tip-force model allocates nothing, whatever its inputs.

#[path = "common/counting.rs"]
mod counting;

use std::sync::atomic::AtomicBool;

use counting::calls;
use nima::tip_force::{DEFAULT_INPUTS, DataSet, Estimator, Model, Selection, Settings};

#[test]
fn an_answer_on_the_default_inputs_with_the_default_network_allocates_nothing() {
    let mut generator = fastrand::Rng::with_seed(1);
    let mut text = DEFAULT_INPUTS.join(",") + ",tip_fx_n,tip_fy_n,tip_fz_n\n";
    for _ in 0..400 {
        let row: Vec<String> = (0..16).map(|_| (generator.f32() - 0.5).to_string()).collect();
        text += &(row.join(",") + "\n");
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("d.csv");
    std::fs::write(&path, text).unwrap();
    let data = DataSet::read(&[path], &Selection::default()).unwrap();
    let settings = Settings { epochs: Some(1), ..Settings::default() };
    let model = Model::train(&data, &settings, [None, None], &AtomicBool::new(false), &|_| {}).unwrap();
    let mut estimator = Estimator::new(model);
    let before = calls();
    let mut doubted = 0_u32;
    for row in 0..data.rows() {
        doubted += u32::from(estimator.estimate(data.input(row)).in_doubt);
    }
    assert!(estimator.estimate(&[f32::NAN; 13]).in_doubt && estimator.estimate(&[]).in_doubt);
    assert_eq!(calls() - before, 0);
    assert!(doubted < 400);
    drop(std::hint::black_box(vec![1_u8; 10]));
    assert_eq!(calls() - before, 2, "the counter counts");
}
