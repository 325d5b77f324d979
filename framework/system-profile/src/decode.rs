//! Bytes to text: byte order mark, else the pattern of UTF-16, else the encoding of the declaration.
//!
//! The whole file is decoded before it is parsed, because the readers that decode on the fly lose
//! their way in small EUC-KR files.

use std::ops::Range;

use encoding_rs::{Encoding, UTF_8, UTF_16BE, UTF_16LE};

/// A declaration is read from the first so many bytes; a longer one is none.
const MAX_DECLARATION: usize = 1024;

/// Names of EUC-KR that tools write and the Encoding Standard does not list.
const KOREAN_ALIASES: [&str; 4] = ["cp949", "ms949", "uhc", "euckr"];

/// Text, and what was odd on the way to it.
#[derive(Debug)]
pub(crate) struct Decoded {
    pub(crate) text: String,
    pub(crate) oddities: Vec<Oddity>,
}

/// Something that a person should know about the encoding of a file that could be decoded.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Oddity {
    pub(crate) span: Range<usize>,
    pub(crate) message: String,
    pub(crate) help: String,
}

/// The file names an encoding that nobody here knows.
#[derive(Debug)]
pub(crate) struct Undecodable {
    pub(crate) text: String,
    pub(crate) span: Range<usize>,
    pub(crate) message: String,
}

/// Decodes a whole file.
pub(crate) fn decode(bytes: &[u8]) -> Result<Decoded, Undecodable> {
    if bytes.starts_with(&[0xFF, 0xFE, 0, 0]) || bytes.starts_with(&[0, 0, 0xFE, 0xFF]) {
        return Err(Undecodable {
            text: String::new(),
            span: 0..0,
            message: "the file is written in UTF-32".into(),
        });
    }
    let declared = declared_encoding(bytes);
    if let Some((encoding, mark)) = Encoding::for_bom(bytes) {
        return Ok(decode_marked(&bytes[mark..], encoding, declared));
    }
    match bytes {
        [b'<', 0, ..] => return Ok(decode_as(bytes, UTF_16LE, None)),
        [0, b'<', ..] => return Ok(decode_as(bytes, UTF_16BE, None)),
        _ => {}
    }
    let Some(span) = declared else {
        return Ok(decode_as(bytes, UTF_8, None));
    };
    let name = String::from_utf8_lossy(&bytes[span.clone()]).into_owned();
    match encoding_named(&name) {
        Some(encoding) if encoding == UTF_16LE || encoding == UTF_16BE => {
            let mut decoded = decode_as(bytes, UTF_8, Some(&name));
            decoded.oddities.push(Oddity {
                span,
                message: format!("{name} is declared, but the bytes are not UTF-16"),
                help: "the file was read as UTF-8; write encoding=\"utf-8\"".into(),
            });
            Ok(decoded)
        }
        Some(encoding) => Ok(decode_as(bytes, encoding, Some(&name))),
        None => Err(Undecodable {
            text: String::from_utf8_lossy(bytes).into_owned(),
            span,
            message: format!("the encoding {name} is not known"),
        }),
    }
}

/// A byte order mark is proof; a declaration that contradicts it is only remarked upon.
fn decode_marked(
    bytes: &[u8],
    encoding: &'static Encoding,
    declared: Option<Range<usize>>,
) -> Decoded {
    let mut decoded = decode_as(bytes, encoding, None);
    let mark = UTF_8_MARK.len();
    let Some(span) = declared.and_then(|span| Some(span.start.checked_sub(mark)?..span.end - mark))
    else {
        return decoded;
    };
    let name = decoded.text.get(span.clone()).unwrap_or_default();
    if encoding_named(name) != Some(encoding) {
        let message = format!(
            "{name} is declared, but the file begins with the byte order mark of {}",
            encoding.name()
        );
        decoded.oddities.push(Oddity {
            span,
            message,
            help: format!(
                "the file was read as {}; correct the declaration",
                encoding.name()
            ),
        });
    }
    decoded
}

const UTF_8_MARK: [u8; 3] = [0xEF, 0xBB, 0xBF];

fn decode_as(bytes: &[u8], encoding: &'static Encoding, declared: Option<&str>) -> Decoded {
    let (text, had_errors) = encoding.decode_without_bom_handling(bytes);
    let text = text.into_owned();
    let mut oddities = Vec::new();
    if had_errors {
        let start = text.find(char::REPLACEMENT_CHARACTER).unwrap_or_default();
        let count = text.matches(char::REPLACEMENT_CHARACTER).count();
        let help = match declared {
            Some(name) => format!(
                "save the file as {name}, or declare the encoding it was saved in; \
                 they were read as U+FFFD"
            ),
            None => "declare the encoding that the file was saved in, for example \
                     <?xml version=\"1.0\" encoding=\"euc-kr\"?>; they were read as U+FFFD"
                .into(),
        };
        oddities.push(Oddity {
            span: start..start + char::REPLACEMENT_CHARACTER.len_utf8(),
            message: format!(
                "bytes that are no {} text; the first of {count} such places",
                encoding.name()
            ),
            help,
        });
    }
    Decoded { text, oddities }
}

fn encoding_named(name: &str) -> Option<&'static Encoding> {
    let lower = name.to_ascii_lowercase();
    if KOREAN_ALIASES.contains(&lower.as_str()) {
        return Some(encoding_rs::EUC_KR);
    }
    Encoding::for_label_no_replacement(name.as_bytes())
}

/// Where the declaration in the ASCII head names the encoding.
fn declared_encoding(bytes: &[u8]) -> Option<Range<usize>> {
    let skipped = if bytes.starts_with(&UTF_8_MARK) {
        UTF_8_MARK.len()
    } else {
        0
    };
    let head = &bytes[skipped..bytes.len().min(MAX_DECLARATION)];
    if !head.starts_with(b"<?xml") {
        return None;
    }
    let declaration = &head[..find(head, b"?>")?];
    let mut position = find(declaration, b"encoding")? + b"encoding".len();
    let skip_blanks = |position: usize| {
        let blanks = declaration[position..]
            .iter()
            .take_while(|byte| byte.is_ascii_whitespace());
        position + blanks.count()
    };
    position = skip_blanks(position);
    if declaration.get(position) != Some(&b'=') {
        return None;
    }
    position = skip_blanks(position + 1);
    let quote = *declaration
        .get(position)
        .filter(|byte| matches!(byte, b'"' | b'\''))?;
    let start = position + 1;
    let length = declaration[start..]
        .iter()
        .position(|byte| *byte == quote)?;
    Some(skipped + start..skipped + start + length)
}

fn find(bytes: &[u8], pattern: &[u8]) -> Option<usize> {
    bytes
        .windows(pattern.len())
        .position(|window| window == pattern)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn utf_16(text: &str, encode: fn(u16) -> [u8; 2]) -> Vec<u8> {
        text.encode_utf16().flat_map(encode).collect()
    }

    #[test]
    fn every_encoding_gives_the_same_text() {
        let body = "<a>안산시</a>";
        let korean = encoding_rs::EUC_KR.encode(body).0.into_owned();
        for name in ["euc-kr", "EUC-KR", "cp949", "ks_c_5601-1987"] {
            let mut bytes = format!("<?xml version='1.0' encoding = '{name}'?>").into_bytes();
            bytes.extend(&korean);
            let decoded = decode(&bytes).unwrap();
            assert!(decoded.text.ends_with(body), "{name}");
            assert_eq!(decoded.oddities, []);
        }
        for bytes in [
            body.as_bytes().to_vec(),
            [&UTF_8_MARK, body.as_bytes()].concat(),
            utf_16(body, u16::to_le_bytes),
            utf_16(body, u16::to_be_bytes),
            utf_16(&format!("\u{FEFF}{body}"), u16::to_le_bytes),
            utf_16(&format!("\u{FEFF}{body}"), u16::to_be_bytes),
        ] {
            assert_eq!(decode(&bytes).unwrap().text, body);
        }
    }

    #[test]
    fn a_small_korean_file_is_read() {
        let bytes = b"<?xml version=\"1.0\" encoding=\"euc-kr\"?><a>\xBE\xC8</a>";
        assert!(decode(bytes).unwrap().text.ends_with("<a>안</a>"));
    }

    #[test]
    fn windows_1252_is_read() {
        let bytes = b"<?xml version='1.0' encoding='windows-1252'?><a>\x80\xE9</a>";
        assert!(decode(bytes).unwrap().text.ends_with("<a>€é</a>"));
    }

    #[test]
    fn an_unknown_name_is_an_error_at_the_name() {
        let bytes = b"<?xml version='1.0' encoding='klingon'?><a/>";
        let failure = decode(bytes).unwrap_err();
        assert_eq!(&failure.text[failure.span], "klingon");
        assert!(decode(&[0xFF, 0xFE, 0, 0]).is_err());
    }

    #[test]
    fn wrong_bytes_are_remarked_upon_once() {
        let decoded = decode(b"<a>\xBE\xC8 \xFF</a>").unwrap();
        let [oddity] = &decoded.oddities[..] else {
            panic!("one oddity");
        };
        assert_eq!(oddity.span.start, 3);
        assert!(oddity.help.contains("euc-kr"));
    }

    #[test]
    fn a_contradicted_declaration_is_remarked_upon() {
        let marked = [
            &UTF_8_MARK[..],
            b"<?xml version='1.0' encoding='euc-kr'?><a/>",
        ]
        .concat();
        let decoded = decode(&marked).unwrap();
        assert_eq!(&decoded.text[decoded.oddities[0].span.clone()], "euc-kr");
        let plain = decode(b"<?xml version='1.0' encoding='utf-16'?><a/>").unwrap();
        assert_eq!(plain.oddities.len(), 1);
    }
}
