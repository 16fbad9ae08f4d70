use nima_core::calibration::Verdict;

use super::*;
use crate::{Terms, calibrate};

#[test]
fn a_lens_is_found_from_rendered_boards_within_half_a_percent() {
    let mut rng = Rng::with_seed(11);
    for k1 in [-0.3, 0.25] {
        let real = lens(k1);
        let poses = usual(&mut rng, &real, &board(), 12);
        let views = rendered(&mut rng, &real, &poses, Sensor::USUAL);
        let report = calibrate(&board(), SIZE_PX, &views);
        let found = report.lens.unwrap();
        println!("{found:?}\n{:?}", report.coverage.fraction());
        assert_eq!((report.verdict(), report.used.len()), (Verdict::Accepted, 12), "{:?}", report.cause);
        assert!(error(&found.lens, &real) < 0.005, "{:?}", found.lens);
        assert!(found.held_out_px < 0.3 && bend_px(&found.lens, &real) < 2.0, "{found:?}");
    }
}

#[test]
fn terms_are_found_where_the_lens_has_them_and_left_out_where_not() {
    let mut rng = Rng::with_seed(12);
    let simple = lens(-0.28);
    let aspect = Lens { focal_px: Vector2::new(760.0, 735.0), ..simple };
    let radial = Lens { bend: Bend { k1: -0.3, k2: 0.12, p1: 0.0, p2: 0.0 }, ..simple };
    let tangential = Lens { bend: Bend { k1: -0.2, k2: 0.0, p1: 0.004, p2: -0.005 }, ..simple };
    let none = Terms::default();
    for (real, wanted) in [
        (simple, none),
        (aspect, Terms { aspect: true, ..none }),
        (radial, Terms { k2: true, ..none }),
        (tangential, Terms { tangential: true, ..none }),
    ] {
        let poses = usual(&mut rng, &real, &board(), 16);
        let report = calibrate(&board(), SIZE_PX, &noisy(&mut rng, &real, &poses, 0.1));
        let found = report.lens.unwrap();
        assert_eq!(found.terms, wanted, "{real:?} {found:?}");
        assert_eq!(report.verdict(), Verdict::Accepted, "{:?}", report.cause);
        assert!(error(&found.lens, &real) < 0.005 && bend_px(&found.lens, &real) < 1.5, "{found:?}");
    }
}

#[test]
fn the_standard_deviations_are_those_of_many_calibrations() {
    let mut rng = Rng::with_seed(13);
    let real = lens(-0.3);
    let mut scaled = 0.0;
    let mut count = 0.0;
    for _ in 0..16 {
        let poses = usual(&mut rng, &real, &board(), 12);
        let found = calibrate(&board(), SIZE_PX, &noisy(&mut rng, &real, &poses, 0.1)).lens.unwrap();
        let deviations = &found.deviations;
        for (miss, sd) in [
            (found.lens.focal_px.x - 760.0, deviations.focal_px.x),
            (found.lens.centre_px.x - 655.0, deviations.centre_px.x),
            (found.lens.bend.k1 + 0.3, deviations.bend.k1),
        ] {
            scaled += (miss / sd).powi(2);
            count += 1.0;
        }
    }
    let ratio = f64::sqrt(scaled / count);
    assert!((0.7..1.4).contains(&ratio), "errors are {ratio} times the reported ones");
}

#[test]
#[ignore = "figures of docs/results/endoscope.md: some minutes; `./dev figures` runs it"]
fn figures_of_calibrations_from_rendered_boards() {
    let mut rng = Rng::with_seed(14);
    let mut errors = Vec::new();
    let mut held_out = Vec::new();
    let mut refused = 0;
    let mut seen = 0;
    for set in 0..20 {
        let bend = Bend { k1: 0.6 * rng.f64() - 0.3, ..Bend::default() };
        let centre_px = Vector2::new(640.0 + 30.0 * normal(&mut rng), 360.0 + 20.0 * normal(&mut rng));
        let focal_px = Vector2::repeat(650.0 + 350.0 * rng.f64());
        let real = Lens { size_px: SIZE_PX, focal_px, centre_px, bend };
        let sensor =
            Sensor { blur_px: 0.5 + 1.5 * rng.f32(), noise: 1.0 + 5.0 * rng.f64(), edge: 0.3 + 0.6 * rng.f64() };
        let portrait = Portrait::new(&real);
        // Skip a view in which the board is not found, as the wizard does.
        let find_in = |pose| find(&sensor.image(&mut rng, &portrait, &board(), pose), &board()).ok();
        let views: Vec<_> = usual(&mut Rng::with_seed(set), &real, &board(), 16).iter().filter_map(find_in).collect();
        seen += views.len();
        let report = calibrate(&board(), SIZE_PX, &views);
        let found = report.lens.unwrap();
        println!(
            "{set}: {:.3} %, held out {:.3} px, {:?}",
            100.0 * error(&found.lens, &real),
            found.held_out_px,
            report.cause
        );
        refused += usize::from(report.cause.is_some());
        errors.push(100.0 * error(&found.lens, &real));
        held_out.push(found.held_out_px);
    }
    println!("found in {seen} of 320 pictures");
    for (what, values) in [("error of focal lengths and centre, percent", &mut errors), ("held out, px", &mut held_out)]
    {
        values.sort_by(f64::total_cmp);
        println!("{what}: median {:.3}, most {:.3}", values[values.len() / 2], values[values.len() - 1]);
    }
    assert!(errors[errors.len() - 1] < 0.5 && held_out[held_out.len() - 1] < 0.3 && refused == 0, "{refused} refused");
}
