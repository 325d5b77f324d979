//! One file: its text, its tree and the problems found in it.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use sha2::{Digest, Sha256};
use system_model::profile::Located;
use system_model::specification::Place;

use crate::decode::{Decoded, decode};
use crate::node::Node;
use crate::parse::{Strictness, parse};
use crate::problem::{Problem, ProblemLog, Severity};
use crate::source::Source;
use crate::suggest;
use crate::tree::Element;
use crate::well_formed::Malformed;

/// The largest public profile has 25 KiB. What is larger than this is not even read: a robot does
/// not spend its memory on a file that was named by mistake.
pub const MAX_FILE_SIZE: u64 = 8 * 1024 * 1024;

/// No more of a word than this is underlined.
const MAX_WORD_LENGTH: usize = 100;

/// One file: its text, its tree and the problems found in it.
///
/// Reading never fails as a whole: what cannot be read is a document without a tree whose problems
/// say why.
///
/// ```
/// use system_profile::Document;
///
/// let text = b"<sonar><range_min>0.03</range_min><rang_max>3.0</rang_max></sonar>";
/// let document = Document::from_bytes("sonar.xml", text);
/// let sonar = document.root(&["sonar"]).unwrap();
/// let minimum = sonar.value("range_min").and_then(|value| value.number::<f64>());
/// let maximum = sonar.value("range_max").and_then(|value| value.number::<f64>());
/// sonar.finish();
///
/// assert_eq!((minimum, maximum), (Some(0.03), None));
/// let problem = &document.problems()[0];
/// assert_eq!((problem.place.line, problem.place.column), (1, 36));
/// assert_eq!(problem.message, "unknown element <rang_max> in <sonar>");
/// assert!(problem.help.as_ref().unwrap().starts_with("did you mean `range_max`?"));
/// ```
#[derive(Debug)]
pub struct Document {
    log: ProblemLog,
    root: Option<Element>,
    root_name: Option<String>,
    digest: Option<String>,
    malformed: Option<Problem>,
    readable: bool,
}

impl Document {
    /// Opens and parses a file of at most [`MAX_FILE_SIZE`] bytes.
    pub fn open(path: impl Into<PathBuf>) -> Self {
        Self::open_with(path.into(), Strictness::Strict)
    }

    /// As [`Document::open`], with `&` and `<` in the values of attributes read with a warning.
    pub(crate) fn open_forgiving(path: impl Into<PathBuf>) -> Self {
        Self::open_with(path.into(), Strictness::Forgiving)
    }

    fn open_with(path: PathBuf, strictness: Strictness) -> Self {
        match read(&path) {
            Ok(bytes) => Self::from_bytes_with(path, &bytes, strictness),
            Err((message, help)) => {
                let source = Arc::new(Source::new(path, ""));
                let log = ProblemLog::new(Arc::clone(&source));
                log.add(Problem::of_whole_file(&source, message, Some(help)));
                Self::without_tree(log, None)
            }
        }
    }

    /// Parses the bytes of a file; `path` is only its name.
    pub fn from_bytes(path: impl Into<PathBuf>, bytes: &[u8]) -> Self {
        Self::from_bytes_with(path.into(), bytes, Strictness::Strict)
    }

    fn from_bytes_with(path: PathBuf, bytes: &[u8], strictness: Strictness) -> Self {
        let digest = Sha256::digest(bytes);
        let digest = Some(digest.iter().map(|byte| format!("{byte:02x}")).collect());
        match decode(bytes) {
            Ok(decoded) => Self::from_text(path, decoded, digest, strictness),
            Err(failure) => {
                let log = ProblemLog::new(Arc::new(Source::new(path, failure.text)));
                let help = "save the file as UTF-8 and declare encoding=\"utf-8\"; euc-kr, utf-16 \
                            and windows-1252 are read too";
                log.error(failure.span, failure.message, Some(help.into()));
                Self::without_tree(log, digest)
            }
        }
    }

    fn from_text(
        path: PathBuf,
        decoded: Decoded,
        digest: Option<String>,
        strictness: Strictness,
    ) -> Self {
        let source = Arc::new(Source::new(path, decoded.text));
        let log = ProblemLog::new(Arc::clone(&source));
        for oddity in decoded.oddities {
            log.warning(oddity.span, oddity.message, Some(oddity.help));
        }
        let parsed = parse(source.text(), strictness);
        for forgiven in parsed.forgiven {
            let message = format!(
                "not well-formed XML, read all the same: {}",
                forgiven.message
            );
            log.warning(forgiven.span, message, Some(forgiven.help));
        }
        let (root, malformed) = match parsed.root {
            Ok(root) => (Some(root), None),
            Err(malformed) => (None, Some(problem_of(&source, malformed))),
        };
        if let Some(problem) = &malformed {
            log.add(problem.clone());
        }
        Self {
            log,
            root,
            root_name: parsed.root_name,
            digest,
            malformed,
            readable: true,
        }
    }

    fn without_tree(log: ProblemLog, digest: Option<String>) -> Self {
        Self {
            log,
            root: None,
            root_name: None,
            digest,
            malformed: None,
            readable: false,
        }
    }

    /// The file, as it was named.
    pub fn path(&self) -> &Path {
        self.log.source().path()
    }

    /// Whether the file could be opened and decoded; a malformed one could.
    pub fn is_readable(&self) -> bool {
        self.readable
    }

    /// The SHA-256 of the file's bytes in hexadecimal, if they could be read.
    pub fn sha256(&self) -> Option<&str> {
        self.digest.as_deref()
    }

    /// The outermost element, if the document is well-formed.
    pub fn tree(&self) -> Option<&Element> {
        self.root.as_ref()
    }

    /// The name of the outermost element, also of a document that is malformed further on.
    pub fn root_name(&self) -> Option<&str> {
        self.root_name.as_deref()
    }

    /// The outermost element for typed reading. An element that is not one of `expected` is an
    /// error that lists them; in a document without a tree there is nothing more to say.
    pub fn root(&self, expected: &[&str]) -> Option<Node<'_>> {
        let root = self.root.as_ref()?;
        if expected.contains(&root.name.as_str()) {
            return Some(Node::new(root, &self.log));
        }
        self.log.error(
            root.name_span.clone(),
            format!(
                "the outermost element <{}> is not understood",
                suggest::quoted(&root.name)
            ),
            suggest::help(&root.name, "it may be", expected.iter().copied()),
        );
        None
    }

    /// Where the document is not well-formed.
    pub fn malformed(&self) -> Option<&Problem> {
        self.malformed.as_ref()
    }

    /// All problems found so far, sorted by place.
    pub fn problems(&self) -> Vec<Problem> {
        self.log.problems()
    }

    /// Whether any problem found so far is an error.
    pub fn has_errors(&self) -> bool {
        self.log.has_errors()
    }

    /// Whether further problems would change nothing: the list is full of errors.
    pub(crate) fn is_given_up(&self) -> bool {
        !self.log.has_room_for(Severity::Error)
    }

    pub(crate) fn log(&self) -> &ProblemLog {
        &self.log
    }

    pub(crate) fn place(&self, offset: usize) -> Place {
        self.log.source().place(offset)
    }

    /// Adds an error about the outermost element.
    pub fn report_root(&self, message: impl Into<String>, help: &str) {
        let span = self.root.as_ref().map(|root| root.name_span.clone());
        self.log
            .error(span.unwrap_or_default(), message, Some(help.to_owned()));
    }

    /// Adds a problem with the word that begins at a place of this file.
    pub(crate) fn report_at(
        &self,
        severity: Severity,
        place: &Place,
        message: impl Into<String>,
        help: Option<String>,
    ) {
        if !self.log.has_room_for(severity) {
            self.log.count(severity);
            return;
        }
        let source = self.log.source();
        let rest = source.span(place, MAX_WORD_LENGTH);
        let word = source.text()[rest.clone()]
            .find(|sign: char| sign.is_whitespace() || "<>\"'=".contains(sign));
        let length = word.unwrap_or(rest.len()).max(1).min(rest.len());
        let span = rest.start..rest.start + length;
        self.log
            .add(Problem::new(severity, source, span, message, help));
    }

    /// Adds a problem with a text that was read from this file.
    pub fn report(
        &self,
        severity: Severity,
        text: &Located<String>,
        message: impl Into<String>,
        help: Option<String>,
    ) {
        if !self.log.has_room_for(severity) {
            self.log.count(severity);
            return;
        }
        let source = self.log.source();
        let span = source.span(&text.place, text.value.chars().count().max(1));
        self.log
            .add(Problem::new(severity, source, span, message, help));
    }
}

fn problem_of(source: &Arc<Source>, malformed: Malformed) -> Problem {
    let Malformed {
        span,
        message,
        help,
    } = malformed;
    let message = format!("not well-formed XML: {message}");
    Problem::new(Severity::Error, source, span, message, Some(help))
}

/// Reads a whole regular file. Pipes and devices are refused: waiting for one could last for ever.
fn read(path: &Path) -> Result<Vec<u8>, (String, String)> {
    let unreadable = |error: std::io::Error| {
        let help = "check the name, and that you may read it".to_owned();
        (format!("the file cannot be read: {error}"), help)
    };
    let metadata = std::fs::metadata(path).map_err(unreadable)?;
    if !metadata.is_file() {
        let help = "name an XML file".to_owned();
        return Err(("this is not a regular file".into(), help));
    }
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(unreadable)?;
    let mut limited = file.take(MAX_FILE_SIZE + 1);
    if metadata.len() <= MAX_FILE_SIZE {
        limited.read_to_end(&mut bytes).map_err(unreadable)?;
    }
    if metadata.len() > MAX_FILE_SIZE || bytes.len() as u64 > MAX_FILE_SIZE {
        let size = metadata.len().max(bytes.len() as u64);
        return Err((
            format!("the file has {size} bytes; at most {MAX_FILE_SIZE} are read"),
            "no profile is that large: is this the right file?".into(),
        ));
    }
    Ok(bytes)
}
