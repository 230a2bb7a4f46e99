{% if general %}
    // The pendulum as data; a kernel made for one scene has it in its text instead.
    let a = from_parts(job.a);
    let b = from_parts(job.b);
    let p = from_parts(job.p);
    let least_det = from_parts(job.least_det);
{% endif %}
