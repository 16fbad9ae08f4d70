use nima_core::calibration::Verdict;

use super::*;
use crate::{CameraCause, CameraSession, LeftOut, ViewOutcome, ViewRequest, calibrate};

fn cause(views: &[BoardSight]) -> CameraCause {
    let report = calibrate(&board(), SIZE_PX, views);
    assert_ne!(report.verdict(), Verdict::Accepted, "{report:?}");
    report.cause.unwrap()
}

#[test]
fn every_degenerate_set_is_refused_with_its_cause() {
    let mut rng = Rng::with_seed(21);
    let lens = lens(-0.25);
    let board = board();
    for _ in 0..3 {
        let good = usual(&mut rng, &lens, &board, 12);
        let few = cause(&noisy(&mut rng, &lens, &good[..5], 0.1));
        assert_eq!(few, CameraCause::TooFew { used: 5, needed: 8 });
        assert_eq!(cause(&[]), CameraCause::TooFew { used: 0, needed: 8 });
        // The same pose again and again.
        let same = cause(&noisy(&mut rng, &lens, &vec![good[1]; 14], 0.1));
        assert_eq!(same, CameraCause::Repeated { repeated: 13, of: 14 });
        // Blurred.
        let mut blurred = noisy(&mut rng, &lens, &good, 0.1);
        blurred.iter_mut().skip(3).for_each(|view| view.blur_px = 4.0);
        assert_eq!(cause(&blurred), CameraCause::Blurred { blurred: 9, of: 12 });
        // Moved but never tilted, and tilted but always in the same way.
        for tilt in [[0.0, 0.0, 0.0], [22.0, 10.0, 0.0]] {
            let fractions = (0..12).map(|k| [f64::from(k % 4) * 0.36 - 0.54, f64::from(k / 4) * 0.45 - 0.45]);
            let poses: Vec<_> = fractions
                .map(|fraction| pose(&lens, &board, fraction, 0.1, tilt))
                .filter(|pose| is_whole(&lens, &board, pose))
                .collect();
            assert!(poses.len() >= 8, "{}", poses.len());
            let parallel = cause(&noisy(&mut rng, &lens, &poses, 0.1));
            assert!(matches!(parallel, CameraCause::Parallel { .. }), "{parallel:?}");
        }
        // Tilted about one axis only.
        let tilts = (0..12).map(|k| (f64::from(k % 4) * 0.36 - 0.54, f64::from(k) * 5.0 - 27.0));
        let poses: Vec<_> = tilts.map(|(x, tilt)| pose(&lens, &board, [x, 0.3 * x], 0.1, [0.0, tilt, 0.0])).collect();
        let one_way = cause(&noisy(&mut rng, &lens, &poses, 0.1));
        assert!(matches!(one_way, CameraCause::OneWay { .. }), "{one_way:?}");
        // Only in the middle.
        let middle = (0..14).map(|k| {
            let turn = f64::from(k) * 1.9;
            pose(
                &lens,
                &board,
                [0.1 * turn.cos(), 0.1 * turn.sin()],
                0.19,
                [26.0 * turn.cos(), 26.0 * turn.sin(), 40.0 * turn],
            )
        });
        let covered = cause(&noisy(&mut rng, &lens, &middle.collect::<Vec<_>>(), 0.1));
        assert!(matches!(covered, CameraCause::Coverage { .. }), "{covered:?}");
        // Corners in wrong positions.
        let poor = cause(&noisy(&mut rng, &lens, &good, 2.0));
        assert!(matches!(poor, CameraCause::HeldOut { .. }), "{poor:?}");
    }
}

#[test]
fn a_view_that_was_misread_is_left_out() {
    let mut rng = Rng::with_seed(22);
    let lens = lens(-0.25);
    let poses = usual(&mut rng, &lens, &board(), 13);
    let mut views = noisy(&mut rng, &lens, &poses, 0.1);
    for (at, corner) in views[6].corners_px.iter_mut().enumerate() {
        corner.x += 6.0 * f64::sin(at as f64 * 0.2);
    }
    let report = calibrate(&board(), SIZE_PX, &views);
    assert_eq!(report.left_out, [(6, LeftOut::Outlier)]);
    assert_eq!(report.verdict(), Verdict::Accepted, "{:?}", report.cause);
    assert!(error(&report.lens.unwrap().lens, &lens) < 0.005);
}

#[test]
fn who_follows_the_session_has_a_good_set() {
    let mut rng = Rng::with_seed(23);
    let lens = lens(-0.3);
    let board = board();
    let mut session = CameraSession::new(board, SIZE_PX);
    let mut asked = Vec::new();
    for _ in 0..60 {
        let ask = session.asks();
        asked.push(ask);
        let mut vary = |by: f64| by * (2.0 * rng.f64() - 1.0);
        let near = [vary(0.3), vary(0.2)];
        let (fraction, tilts) = match ask {
            ViewRequest::Complete => break,
            ViewRequest::Flat => ([0.0, 0.0], [0.0, 0.0]),
            ViewRequest::Tilted(way) => {
                let tilts = match way {
                    crate::LensSide::Left => [0.0, -28.0],
                    crate::LensSide::Right => [0.0, 28.0],
                    // A rotation about x moves the lower side away.
                    crate::LensSide::Up => [28.0, 0.0],
                    crate::LensSide::Down => [-28.0, 0.0],
                };
                (near, tilts)
            }
            ViewRequest::There(crate::Region([column, row])) => (
                [0.62 * (column as f64 - 1.0) + vary(0.1), 0.55 * (row as f64 - 1.0) + vary(0.1)],
                [vary(15.0), vary(15.0)],
            ),
            ViewRequest::Other => (near, [vary(25.0), vary(25.0)]),
        };
        let pose = pose(&lens, &board, fraction, 0.085, [tilts[0], tilts[1], vary(10.0)]);
        if !is_whole(&lens, &board, &pose) {
            continue;
        }
        let sight = noisy(&mut rng, &lens, &[pose], 0.05).remove(0);
        assert_eq!(session.offer(sight.clone()), ViewOutcome::Moving, "one image cannot show that it is held still");
        let offer = session.offer(sight.clone());
        assert!(matches!(offer, ViewOutcome::Taken | ViewOutcome::TakenHere), "{offer:?}");
        assert_eq!(session.offer(sight), ViewOutcome::TakenHere);
    }
    assert_eq!(session.asks(), ViewRequest::Complete, "{asked:?}");
    let report = calibrate(&board, SIZE_PX, session.views());
    assert_eq!(report.verdict(), Verdict::Accepted, "{:?}", report.cause);
    session.undo();
    assert_eq!(session.views().len(), report.used.len() - 1);
}
