//! The serial line protocol: round trips, damage, garbage.

use proptest::prelude::*;
use robot_interface::serial_line::{
    BoardReport, Decoder, MAXIMUM_FRAME_LENGTH, Message, MotionCommand, MotionType, encode,
};

fn motion_type() -> impl Strategy<Value = MotionType> {
    prop_oneof![
        Just(MotionType::Stop),
        Just(MotionType::Forward),
        Just(MotionType::Backward),
        Just(MotionType::TurnLeft),
        Just(MotionType::TurnRight),
    ]
}

fn message() -> impl Strategy<Value = Message> {
    let command = (motion_type(), any::<i16>(), any::<i16>()).prop_map(
        |(motion_type, rpm, rpm_difference)| {
            Message::Command(MotionCommand {
                motion_type,
                rpm,
                rpm_difference,
            })
        },
    );
    let report = (
        any::<u16>(),
        any::<bool>(),
        any::<[i32; 2]>(),
        any::<[u16; 4]>(),
    )
        .prop_map(
            |(sequence, stopped_by_time_out, [left, right], ranges_mm)| {
                Message::Report(BoardReport {
                    sequence,
                    stopped_by_time_out,
                    left_encoder_ticks: left,
                    right_encoder_ticks: right,
                    ranges_mm,
                })
            },
        );
    prop_oneof![command, report]
}

/// Bytes that cannot begin a frame.
fn garbage() -> impl Strategy<Value = Vec<u8>> {
    prop::collection::vec(
        any::<u8>().prop_filter("no start mark", |&byte| byte != 0xA5),
        0..60,
    )
}

proptest! {
    #[test]
    fn messages_survive_garbage_between_them_and_any_split(
        parts in prop::collection::vec((garbage(), message()), 0..8),
        piece in 1_usize..70,
    ) {
        let stream: Vec<u8> = parts
            .iter()
            .flat_map(|(garbage, message)| [garbage.clone(), encode(message)].concat())
            .collect();
        let mut decoder = Decoder::new();
        let received: Vec<Message> =
            stream.chunks(piece).flat_map(|bytes| decoder.push(bytes)).collect();
        let sent: Vec<Message> = parts.into_iter().map(|(_, message)| message).collect();
        prop_assert_eq!(received, sent);
        prop_assert_eq!(decoder.bad_frames(), 0);
    }

    #[test]
    fn a_flipped_bit_is_never_a_message_and_the_next_frame_is_not_lost(
        damaged in message(),
        bit in 0..8 * MAXIMUM_FRAME_LENGTH,
        next in message(),
    ) {
        let mut stream = encode(&damaged);
        let bit = bit % (8 * stream.len());
        stream[bit / 8] ^= 1 << (bit % 8);
        stream.extend(encode(&next));
        // A damaged length may ask for bytes of the frame behind the next one.
        stream.extend([0; MAXIMUM_FRAME_LENGTH]);
        prop_assert_eq!(Decoder::new().push(&stream), [next]);
    }

    #[test]
    fn random_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..2000)) {
        let mut decoder = Decoder::new();
        decoder.push(&bytes);
        let whole = Message::Command(MotionCommand::stop());
        let flush = [encode(&whole), vec![0; MAXIMUM_FRAME_LENGTH]].concat();
        let messages = decoder.push(&flush);
        prop_assert_eq!(messages.last(), Some(&whole));
    }

    #[test]
    fn wheel_speeds_survive_the_command(left in -300..300_i16, right in -300..300_i16) {
        let sent = (f64::from(left), f64::from(right));
        let (left, right) = MotionCommand::from_wheel_rpm(sent.0, sent.1).wheel_rpm();
        prop_assert!((left - sent.0).abs() <= 0.5 && (right - sent.1).abs() <= 0.5);
    }
}

#[test]
fn motions_have_the_codes_and_signs_of_table_4() {
    let cases = [
        (MotionType::Stop, 0, (0.0, 0.0)),
        (MotionType::Forward, 1, (30.0, 50.0)),
        (MotionType::Backward, 2, (-50.0, -30.0)),
        (MotionType::TurnLeft, 3, (30.0, 50.0)),
        (MotionType::TurnRight, 4, (50.0, 30.0)),
    ];
    for (motion_type, code, wheel_rpm) in cases {
        let command = MotionCommand {
            motion_type,
            rpm: 40,
            rpm_difference: 20,
        };
        assert_eq!(command.wheel_rpm(), wheel_rpm, "{motion_type:?}");
        assert_eq!(
            encode(&Message::Command(command))[4],
            code,
            "{motion_type:?}"
        );
    }
}

#[test]
fn a_damaged_frame_is_counted() {
    let mut frame = encode(&Message::Command(MotionCommand::stop()));
    frame[5] ^= 0x10;
    let mut decoder = Decoder::new();
    assert!(decoder.push(&frame).is_empty());
    assert_eq!(decoder.bad_frames(), 1);
}
