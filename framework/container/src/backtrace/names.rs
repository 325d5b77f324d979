//! Names and places of functions, from a library's debug information or its table of symbols.

use std::cell::OnceCell;

use addr2line::gimli::{Dwarf, EndianSlice, RunTimeEndian, SectionId};
use addr2line::{Context, Frame, demangle_auto};
use object::{Object as _, ObjectSection as _, SymbolMap, SymbolMapName};

type Slice<'content> = EndianSlice<'content, RunTimeEndian>;

/// What a library tells of its code; nothing, if the file is none.
#[derive(Default)]
pub(super) struct Names<'content> {
    context: Option<Context<Slice<'content>>>,
    file: Option<object::File<'content>>,
    /// Read only if the debug information does not know a function: there are thousands.
    symbols: OnceCell<SymbolMap<SymbolMapName<'content>>>,
}

impl<'content> Names<'content> {
    /// Reads the tables of a library.
    pub(super) fn of(content: &'content [u8]) -> Self {
        let Ok(file) = object::File::parse(content) else {
            return Self::default();
        };
        let endian = if file.is_little_endian() {
            RunTimeEndian::Little
        } else {
            RunTimeEndian::Big
        };
        // A section that is missing, or compressed, is as good as empty.
        let load = |id: SectionId| {
            let section = file.section_by_name(id.name());
            let data = section.and_then(|section| section.data().ok());
            Ok::<_, addr2line::gimli::Error>(EndianSlice::new(data.unwrap_or_default(), endian))
        };
        Self {
            context: Dwarf::load(load).and_then(Context::from_dwarf).ok(),
            file: Some(file),
            symbols: OnceCell::new(),
        }
    }

    /// The function at an address as the file counts, and behind it those that it was inlined
    /// into; never nothing.
    pub(super) fn at(&self, address: u64) -> Vec<String> {
        let mut lines = Vec::new();
        let frames = self
            .context
            .as_ref()
            .and_then(|context| context.find_frames(address).skip_all_loads().ok());
        if let Some(mut frames) = frames {
            while let Ok(Some(frame)) = frames.next() {
                lines.push(self.line(&frame, address));
            }
        }
        if lines.is_empty() {
            lines.push(self.symbol(address));
        }
        lines
    }

    fn line(&self, frame: &Frame<'_, Slice<'_>>, address: u64) -> String {
        let name = frame
            .function
            .as_ref()
            .and_then(|function| function.demangle().ok())
            .map_or_else(|| self.symbol(address), |name| name.into_owned());
        let place = frame.location.as_ref();
        match place.and_then(|place| place.file.zip(place.line)) {
            Some((file, line)) => format!("{name} at {file}:{line}"),
            None => name,
        }
    }

    fn symbol(&self, address: u64) -> String {
        let symbols = self.file.as_ref();
        let symbols = symbols.map(|file| self.symbols.get_or_init(|| file.symbol_map()));
        let symbol = symbols.and_then(|all| all.before(address));
        symbol.map_or_else(
            || "unknown function".to_owned(),
            |symbol| demangle_auto(symbol.name().into(), None).into_owned(),
        )
    }
}
