use gridwalk_render::image::{Tonemap, srgb_decode, srgb_encode, srgb_encode_u8};

/// The values were computed in double precision from the published formulas.
#[test]
fn golden_values() {
    let inputs = [[0.18, 0.18, 0.18], [1.0, 0.5, 0.25], [4.0, 2.0, 0.1], [0.02, 0.3, 0.7]];
    let expected: [(Tonemap, [[f32; 3]; 4]); 5] = [
        (Tonemap::None, [[0.18, 0.18, 0.18], [1.0, 0.5, 0.25], [1.0, 1.0, 0.1], [0.02, 0.3, 0.7]]),
        (
            Tonemap::Reinhard,
            [[0.152542, 0.152542, 0.152542], [0.629624, 0.314812, 0.157406], [1.0, 0.608269, 0.030413], [0.015756, 0.236341, 0.551462]],
        ),
        (
            Tonemap::Aces,
            [[0.105591, 0.105591, 0.105590], [0.634990, 0.384600, 0.203160], [0.950185, 0.811816, 0.313325], [0.0, 0.210145, 0.475664]],
        ),
        (
            Tonemap::Agx,
            [
                [0.214467, 0.214533, 0.214537],
                [0.610114, 0.431149, 0.291676],
                [0.910615, 0.773103, 0.335667],
                [0.088265, 0.324707, 0.527851],
            ],
        ),
        (Tonemap::Neutral, [[0.14, 0.14, 0.14], [0.869091, 0.422529, 0.199248], [0.983256, 0.639951, 0.313812], [0.0025, 0.2825, 0.6825]]),
    ];
    for (tonemap, outputs) in expected {
        for (input, output) in inputs.iter().zip(outputs) {
            let got = tonemap.apply(*input);
            for channel in 0..3 {
                assert!((got[channel] - output[channel]).abs() < 2e-5, "{} of {input:?}: {got:?}, expected {output:?}", tonemap.name());
            }
        }
    }
}

#[test]
fn hostile_values_stay_in_range() {
    let values = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, -0.0, 0.0, f32::MIN_POSITIVE, 1e-45, f32::MAX, f32::MIN, 0.18];
    for tonemap in Tonemap::ALL {
        for r in values {
            for g in values {
                for b in values {
                    let got = tonemap.apply([r, g, b]);
                    assert!(got.iter().all(|value| (0.0..=1.0).contains(value)), "{} of {:?}: {got:?}", tonemap.name(), [r, g, b]);
                }
            }
        }
        assert!(tonemap.apply([f32::NAN; 3]).iter().all(|value| *value < 1e-3), "{}: not a number is black", tonemap.name());
        assert!(tonemap.apply([f32::INFINITY; 3]).iter().all(|value| *value > 0.9), "{}: infinity is white", tonemap.name());
    }
}

#[test]
fn brighter_stays_brighter() {
    for tonemap in Tonemap::ALL {
        let mut last = -1.0;
        for step in 0..2000 {
            let value = 2.0_f32.powf(step as f32 / 100.0 - 12.0);
            let got = tonemap.apply([value; 3])[1];
            assert!(got >= last - 1e-6, "{} falls at {value}: {last} to {got}", tonemap.name());
            last = got;
        }
    }
}

#[test]
fn names_are_found_again() {
    for tonemap in Tonemap::ALL {
        assert_eq!(Tonemap::from_name(tonemap.name()), Some(tonemap));
    }
    assert_eq!(Tonemap::from_name("filmic"), None);
}

#[test]
fn srgb_is_exact_to_eight_bits() {
    for stored in 0..=255_u8 {
        let linear = srgb_decode(f32::from(stored) / 255.0);
        assert_eq!(srgb_encode_u8(linear), stored);
    }
    // Every float between two codes goes to the code that the curve in double precision rounds to, but for those within 1e-5 of a tie.
    let mut checked = 0;
    for i in 0..200_000 {
        let linear = i as f32 / 199_999.0;
        let wide = f64::from(linear);
        let exact = 255.0 * if wide <= 0.0031308 { wide * 12.92 } else { 1.055 * wide.powf(1.0 / 2.4) - 0.055 };
        if ((exact - exact.floor()) - 0.5).abs() > 1e-4 {
            assert_eq!(f64::from(srgb_encode_u8(linear)), exact.round(), "{linear}");
            checked += 1;
        }
    }
    assert!(checked > 190_000);
    assert!((srgb_encode(1.0) - 1.0).abs() < 1e-6 && srgb_encode(0.0) == 0.0);
    assert_eq!([srgb_encode_u8(f32::NAN), srgb_encode_u8(-1.0), srgb_encode_u8(f32::INFINITY)], [0, 0, 255]);
}
