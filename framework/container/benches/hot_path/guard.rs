//! A guarded call of an empty callback against a plain call through the same table.

use std::hint::black_box;
use std::time::Duration;

use component_abi::{Callbacks, HostContext, HostTable, Instance, Status};
use container::guard::loss::Loss;
use container::guard::{CallLimit, Callback, CodeRange, Guarded, HostServices, Request};
use criterion::Criterion;

/// Callbacks that do nothing.
const EMPTY: Callbacks = Callbacks {
    create: Some(create),
    destroy_instance: Some(destroy_instance),
    on_execute: Some(on_execute),
    ..Callbacks::NONE
};

unsafe extern "C" fn create(_: *const HostTable, _: *mut HostContext) -> *mut Instance {
    std::ptr::dangling_mut()
}

unsafe extern "C" fn destroy_instance(_: *mut Instance) {}

#[inline(never)]
unsafe extern "C" fn on_execute(instance: *mut Instance) -> Status {
    black_box(instance);
    Status::SUCCESS
}

struct NoServices;

impl HostServices for NoServices {
    fn answer(&mut self, _request: &Request) -> u64 {
        0
    }
}

pub fn bench(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("guard");
    group.bench_function("plain_call", |bencher| {
        let table = black_box(EMPTY);
        bencher.iter(|| {
            let function = black_box(table.on_execute).expect("it is set");
            // SAFETY: the function ignores its argument.
            unsafe { function(std::ptr::dangling_mut()) }
        });
    });
    group.bench_function("guarded_call", |bencher| {
        let code = CodeRange { start: 0, end: 0 };
        let mut guarded = Guarded::new(EMPTY, code, 0).expect("a stack");
        let loss = Loss::default();
        let limit = CallLimit::from(Duration::from_millis(30));
        guarded.call(Callback::Create, limit, &loss, &mut NoServices);
        bencher.iter(|| guarded.call(black_box(Callback::Execute), limit, &loss, &mut NoServices));
    });
    group.finish();
}
