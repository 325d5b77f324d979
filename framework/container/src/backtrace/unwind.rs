//! The call chain on a component's stack.

use framehop::{
    CacheNative, ExplicitModuleSectionInfo, FrameAddress, MayAllocateDuringUnwind, Module,
    UnwindRegsNative, Unwinder as _, UnwinderNative,
};
use object::{Object as _, ObjectSection as _};

use crate::guard::{LoadedObject, Registers};
use crate::library::whole;

/// Calls that are followed, the component's and those of libraries that it called: more than any
/// sane depth of the C library below a component's 32.
const MOST_CALLS: usize = 256;

type Tables = Vec<u8>;

/// Addresses inside the instructions that were being executed, innermost first: in `library` and
/// in those that it called. Ends where the container had called it, or where the stack makes no
/// sense.
pub(super) fn call_chain(
    library: &LoadedObject,
    registers: &Registers,
    stack: impl Fn(usize) -> Option<usize>,
) -> Vec<usize> {
    let mut known = Known::default();
    let mut cache = CacheNative::<MayAllocateDuringUnwind>::new();
    let mut read = |address: u64| {
        let word = usize::try_from(address).ok().and_then(&stack);
        word.map(|word| word as u64).ok_or(())
    };
    let mut chain = Vec::new();
    let mut now = unwind_registers(registers);
    let mut next = Some(FrameAddress::from_instruction_pointer(
        registers.instruction_pointer as u64,
    ));
    while let Some(address) = next.filter(|_| chain.len() < MOST_CALLS) {
        let inside = address.address_for_lookup() as usize;
        if !known.learn(inside, library) {
            break;
        }
        chain.push(inside);
        let caller = known
            .unwinder
            .unwind_frame(address, &mut now, &mut cache, &mut read);
        next = caller
            .ok()
            .flatten()
            .and_then(FrameAddress::from_return_address);
    }
    chain
}

#[cfg(target_arch = "x86_64")]
fn unwind_registers(registers: &Registers) -> UnwindRegsNative {
    UnwindRegsNative::new(
        registers.instruction_pointer as u64,
        registers.stack_pointer as u64,
        registers.frame_pointer as u64,
    )
}

#[cfg(target_arch = "aarch64")]
fn unwind_registers(registers: &Registers) -> UnwindRegsNative {
    UnwindRegsNative::new(
        registers.link as u64,
        registers.stack_pointer as u64,
        registers.frame_pointer as u64,
    )
}

/// The libraries whose tables have been read.
#[derive(Default)]
struct Known {
    unwinder: UnwinderNative<Tables, MayAllocateDuringUnwind>,
    objects: Vec<LoadedObject>,
}

impl Known {
    /// Reads the tables of the library that an address is in; false if it is in none, but in the
    /// container itself.
    fn learn(&mut self, address: usize, library: &LoadedObject) -> bool {
        if self.objects.iter().any(|one| one.code.contains(address)) {
            return true;
        }
        let object = if library.code.contains(address) {
            Some(library.clone())
        } else {
            LoadedObject::around(address).filter(LoadedObject::is_library)
        };
        let Some(object) = object else {
            return false;
        };
        if let Ok(content) = std::fs::read(whole(&object.file))
            && let Ok(file) = object::File::parse(content.as_slice())
        {
            self.unwinder.add_module(module(&object, &file));
        }
        self.objects.push(object);
        true
    }
}

fn module(object: &LoadedObject, file: &object::File<'_>) -> Module<Tables> {
    let section = |name: &str| {
        let section = file.section_by_name(name)?;
        let start = section.address();
        let data = section.data().ok()?.to_vec();
        Some((start..start.saturating_add(section.size()), data))
    };
    let (text_svma, text) = section(".text").unzip();
    let (eh_frame_svma, eh_frame) = section(".eh_frame").unzip();
    let (eh_frame_hdr_svma, eh_frame_hdr) = section(".eh_frame_hdr").unzip();
    let tables = ExplicitModuleSectionInfo {
        text_svma,
        text,
        eh_frame_svma,
        eh_frame,
        eh_frame_hdr_svma,
        eh_frame_hdr,
        ..ExplicitModuleSectionInfo::default()
    };
    Module::new(
        String::new(),
        object.code.start as u64..object.code.end as u64,
        object.base as u64,
        tables,
    )
}
