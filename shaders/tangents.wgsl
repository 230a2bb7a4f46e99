// The tangents of a motion (counterpart: crates/engine/src/cpu/growth.rs).

// Largest slope before all are made smaller by a power of two, so that none overflows.
const LARGE = {{ large }};
const SMALLER = {{ smaller }};
const LOG_LARGE = {{ log_large }};

// No step has to be searched.
fn is_suspect(now: State, step: Step) -> bool {
    return false;
}

// The state after a step, its slopes small again by a power of two that its logarithm remembers.
fn gathered(after: State, step: Step, taken: bool) -> State {
    var now = after;
    var most = 0.0;
{% for name in slopes %}
    most = max(most, abs(rough(now.{{ name }})));
{% endfor %}
    if most > LARGE {
{% for name in slopes %}
        now.{{ name }} = scaled(now.{{ name }}, SMALLER);
{% endfor %}
        now.log_scale = sum_of(now.log_scale, real(LOG_LARGE), zero);
    }
    return now;
}

// Does nothing, because no step has to be searched.
@compute @workgroup_size(WORKGROUP)
fn look() {
}
