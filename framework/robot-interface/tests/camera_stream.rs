//! The camera stream: round trips, damage, garbage.

use proptest::prelude::*;
use robot_interface::camera_stream::{MAXIMUM_PIXELS, Picture, PictureDecoder, encode};

fn picture() -> impl Strategy<Value = Picture> {
    (0..12_u16, 0..12_u16, any::<u64>()).prop_flat_map(|(width, height, time_stamp_ns)| {
        let length = usize::from(width) * usize::from(height) * 3;
        prop::collection::vec(any::<u8>(), length).prop_map(move |pixels| Picture {
            width,
            height,
            time_stamp_ns,
            pixels,
        })
    })
}

proptest! {
    #[test]
    fn pictures_survive_garbage_and_any_split(
        garbage in prop::collection::vec(0..0xC4_u8, 0..50),
        picture in picture(),
        piece in 1_usize..200,
    ) {
        let stream = [garbage, encode(&picture)].concat();
        let mut decoder = PictureDecoder::new();
        let received: Vec<Picture> =
            stream.chunks(piece).filter_map(|bytes| decoder.push(bytes)).collect();
        prop_assert_eq!(received, [picture]);
        prop_assert_eq!(decoder.bad_frames(), 0);
    }

    #[test]
    fn a_damaged_picture_is_rejected_and_the_next_one_arrives(
        damaged in picture(),
        bit in any::<prop::sample::Index>(),
        next in picture(),
    ) {
        let mut stream = encode(&damaged);
        let bit = bit.index(8 * stream.len());
        stream[bit / 8] ^= 1 << (bit % 8);
        stream.extend(encode(&next));
        let mut decoder = PictureDecoder::new();
        prop_assert_eq!(decoder.push(&stream), Some(next));
        prop_assert_eq!(decoder.pictures(), 1);
    }

    #[test]
    fn random_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..2000)) {
        prop_assert_eq!(PictureDecoder::new().push(&bytes), None);
    }
}

fn one_pixel(time_stamp_ns: u64) -> Picture {
    Picture {
        width: 1,
        height: 1,
        time_stamp_ns,
        pixels: vec![1, 2, 3],
    }
}

#[test]
fn the_newest_of_several_pictures_wins() {
    let stream: Vec<u8> = (0..3).flat_map(|time| encode(&one_pixel(time))).collect();
    let mut decoder = PictureDecoder::new();
    assert_eq!(decoder.push(&stream), Some(one_pixel(2)));
    assert_eq!(decoder.pictures(), 3);
}

#[test]
fn a_header_that_promises_too_much_is_not_waited_for() {
    let huge = Picture {
        width: 641,
        height: 480,
        time_stamp_ns: 0,
        pixels: vec![0; 641 * 480 * 3],
    };
    assert!(huge.pixels.len() > 3 * MAXIMUM_PIXELS);
    let mut decoder = PictureDecoder::new();
    assert_eq!(decoder.push(&encode(&huge)[..100]), None);
    assert_eq!(decoder.push(&encode(&one_pixel(7))), Some(one_pixel(7)));
}
