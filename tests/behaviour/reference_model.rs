//! A component of the application plays the reference model of another one.

use tests::{Application, Member};

/// Two counters; the second one is what the first one should do.
fn application(injections: &str) -> Application {
    Application::new()
        .with(&Member::new("counter", "counter"))
        .with(&Member::new("twin", "counter"))
        .with(&Member::new("recorder", "recorder"))
        .connect("data", "counter.output", "recorder.input")
        .rules(
            "<monitor name='against_twin'>
               <process_model model='twin' method='window' window='50' threshold='5'
                              severity='ignore'>
                 <input component='counter' port='output' field='value'/>
                 <output component='counter' port='output' field='value'/>
               </process_model>
             </monitor>",
        )
        .injections(injections)
}

#[test]
fn what_differs_from_the_reference_component_is_found() {
    let outcome = application(
        "<inject at='500ms' component='counter' port='output' field='value' fault='offset'
                 value='20'/>",
    )
    .simulate("1s")
    .ended_well();
    let verdicts = outcome.verdicts();
    let [verdict] = verdicts.as_slice() else {
        panic!("one fault is expected: {verdicts:?}");
    };
    assert_eq!(verdict["kind"], "process_model");
    assert_eq!(verdict["component"], "counter");
    let evidence = &verdict["evidence"]["residual"];
    assert_eq!(evidence["monitor"], "against_twin");
    // The twin comes after the counter: what it said last is one number behind.
    assert_eq!(evidence["residual"], 21.0);
}

#[test]
fn what_does_as_the_reference_component_does_is_no_fault() {
    let outcome = application("<inject at='5s' component='counter' fault='panic'/>")
        .simulate("1s")
        .ended_well();
    assert!(outcome.verdicts().is_empty(), "{:?}", outcome.verdicts());
}
