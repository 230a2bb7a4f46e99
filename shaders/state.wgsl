// A pendulum's numbers, and a step that it takes. The maths of a step is printed from the Rust of
// `flipmap_pendulum`.

struct State {
{% for name in state %}
    {{ name }}: Real,
{% endfor %}
}

fn state_of(pixel: u32) -> State {
    return State(
{% for name in state %}
        states[{{ loop.index0 }}u * job.count + pixel],
{% endfor %}
    );
}

fn keep_state(pixel: u32, state: State) {
{% for name in state %}
    states[{{ loop.index0 }}u * job.count + pixel] = state.{{ name }};
{% endfor %}
}

// `a` where `test` is true, otherwise `b`.
fn chosen(test: bool, a: State, b: State) -> State {
    return State(
{% for name in state %}
        select(b.{{ name }}, a.{{ name }}, test),
{% endfor %}
    );
}

// A step: the state after it, and the quantities by which it is judged.
struct Step {
    next: State,
{% for name in judged %}
    {{ name }}: Real,
{% endfor %}
}

// The step of length `step` from a state; expansions choose their own length.
fn step_from(now: State, step: Real) -> Step {
{% for name in state %}
    let {{ name }} = now.{{ name }};
{% endfor %}
{{ maths.step }}
    return Step(
        State({% for name in state %}{{ name }}{% if name in moving %}_next{% endif %}, {% endfor %}),
{% for name in judged %}
        {{ name }},
{% endfor %}
    );
}

// Returns true if too little energy is left ever to pass the top (see crates/engine/src/slowed.rs).
fn is_slowed(now: State) -> bool {
{% if least_energy %}
{% for name in state %}
    let {{ name }} = now.{{ name }};
{% endfor %}
{{ maths.energy }}
    return rough(energy) < {{ least_energy }};
{% else %}
    return false;
{% endif %}
}
