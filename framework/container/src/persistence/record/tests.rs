//! What was written is read again; whatever else a file holds is refused, and the reason is said.

use proptest::prelude::*;

use super::*;

const NOW: Duration = Duration::from_secs(1_700_000_000);
const MAX_AGE: Duration = Duration::from_secs(60);

fn record() -> Record {
    Record {
        origin: Origin {
            application: "patrol".to_owned(),
            component: "planner/글".to_owned(),
            library: LibraryIdentity::of("libplanner.so".to_owned(), b"ELF"),
        },
        written: 7,
        sequence: 42,
        incarnation: 3,
        taken: NOW,
        memory: (0..100).collect(),
    }
}

fn encoded(record: &Record) -> Vec<u8> {
    let mut bytes = b"what was there before".to_vec();
    record.encode(&mut bytes);
    bytes
}

#[test]
fn a_file_that_was_cut_anywhere_is_torn() {
    let bytes = encoded(&record());
    for length in 0..bytes.len() {
        let refusal = Record::decode(&bytes[..length]).unwrap_err();
        let is_torn = matches!(refusal, Refusal::Torn { has, .. } if has == length as u64);
        assert!(is_torn, "{length}: {refusal}");
    }
    let longer = [bytes.as_slice(), b"x"].concat();
    assert_eq!(
        Record::decode(&longer).unwrap_err().to_string(),
        format!("it is torn: {} bytes of {}", bytes.len() + 1, bytes.len())
    );
}

#[test]
fn a_bit_that_turned_round_anywhere_is_noticed() {
    let bytes = encoded(&record());
    for bit in 0..8 * bytes.len() {
        let mut other = bytes.clone();
        other[bit / 8] ^= 1 << (bit % 8);
        let refusal = Record::decode(&other).unwrap_err();
        let expected = match bit / 8 {
            0..8 => matches!(refusal, Refusal::NoCheckpoint),
            8..12 => matches!(refusal, Refusal::Version { .. }),
            12..20 => matches!(refusal, Refusal::Torn { .. }),
            _ => refusal == Refusal::Checksum,
        };
        assert!(expected, "bit {bit}: {refusal}");
    }
}

#[test]
fn fields_that_do_not_fit_are_refused_even_with_the_right_checksum() {
    let mut bytes = encoded(&record());
    // The length of the first text: far behind the end of the file.
    bytes[48..52].copy_from_slice(&u32::MAX.to_le_bytes());
    let end = bytes.len() - CHECKSUM_BYTES;
    let checksum = crc32c(&bytes[..end]).to_le_bytes();
    bytes[end..].copy_from_slice(&checksum);
    assert_eq!(Record::decode(&bytes), Err(Refusal::Malformed));
}

/// The result of a check, or why not.
fn checked(
    change: impl FnOnce(&mut Record),
    size: Option<usize>,
    now: Duration,
) -> Result<Duration, String> {
    let mut other = record();
    change(&mut other);
    let age = other.age_if_fit(&record().origin, size, now, MAX_AGE);
    age.map_err(|refusal| refusal.to_string())
}

#[test]
fn what_is_foreign_is_refused_by_name() {
    let refused = |change: fn(&mut Record)| checked(change, Some(100), NOW).unwrap_err();
    for (refusal, expected) in [
        (
            refused(|it| it.origin.application = "mapping".to_owned()),
            "it is foreign: of application 'mapping', not 'patrol'",
        ),
        (
            refused(|it| it.origin.component = "camera".to_owned()),
            "it is foreign: of component 'camera', not 'planner/글'",
        ),
        (
            refused(|it| it.origin.library.name = "libother.so".to_owned()),
            "it is foreign: of library 'libother.so', not 'libplanner.so'",
        ),
        (
            refused(|it| it.origin.library.checksum ^= 1),
            "it is foreign: of another build of library 'libplanner.so'",
        ),
        (
            refused(|it| it.memory.push(0)),
            "it is foreign: it has 101 bytes, the registered memory 100",
        ),
    ] {
        assert_eq!(refusal, expected);
    }
    assert_eq!(
        checked(|it| it.memory.push(0), None, NOW),
        Ok(Duration::ZERO)
    );
}

#[test]
fn what_is_stale_is_refused() {
    let seconds = Duration::from_secs;
    for (now, expected) in [
        (NOW, Ok(seconds(0))),
        (NOW + MAX_AGE, Ok(MAX_AGE)),
        (
            NOW + MAX_AGE + seconds(1),
            Err("it is stale: 61.0s old, at most 60s is allowed"),
        ),
        (NOW - CLOCK_TOLERANCE, Ok(seconds(0))),
        (
            NOW - CLOCK_TOLERANCE - seconds(1),
            Err("it is of 11.0s from now: the machine's clock was set back"),
        ),
    ] {
        let expected = expected.map_err(str::to_owned);
        assert_eq!(checked(|_same| {}, Some(100), now), expected, "{now:?}");
    }
}

proptest! {
    #[test]
    fn what_was_written_is_read_again(
        application in ".{0,40}",
        component in ".{0,40}",
        name in ".{0,40}",
        checksum: u32,
        written: u64,
        sequence: u64,
        incarnation: u32,
        taken_ns: u64,
        memory in proptest::collection::vec(any::<u8>(), 0..5000),
    ) {
        let library = LibraryIdentity { name, checksum };
        let record = Record {
            origin: Origin { application, component, library },
            written,
            sequence,
            incarnation,
            taken: Duration::from_nanos(taken_ns),
            memory,
        };
        prop_assert_eq!(Record::decode(&encoded(&record)), Ok(record));
    }

    /// No content of a file makes the reader panic or reserve memory that is not there.
    #[test]
    fn whatever_else_is_there_is_refused(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        prop_assert!(Record::decode(&bytes).is_err());
        let framed = [MAGIC.as_slice(), &VERSION.to_le_bytes(), &bytes].concat();
        prop_assert!(Record::decode(&framed).is_err());
    }
}
