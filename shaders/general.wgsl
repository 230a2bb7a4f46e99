{% if general %}
    // The pendulum as data; a kernel made for one scene has it in its text instead.
    let a = from_parts(job.a);
    let b = from_parts(job.b);
    let p = from_parts(job.p);
    let least_det = from_parts(job.least_det);
{% if adaptive %}
    let inverse_scale1 = real(job.inverse_scale.x);
    let inverse_scale2 = real(job.inverse_scale.y);
{% endif %}
{% endif %}
