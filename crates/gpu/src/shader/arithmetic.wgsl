// The results of operations, as the CPU rounds them.
fn keep(x: f64) -> f64 {
    return bitcast<f64>(bitcast<u64>(x) ^ u64(params.zero));
}

fn plus(a: f64, b: f64) -> f64 {
    return keep(a + b);
}

fn minus(a: f64, b: f64) -> f64 {
    return keep(a - b);
}

fn times_(a: f64, b: f64) -> f64 {
    return keep(a * b);
}

fn over(a: f64, b: f64) -> f64 {
    return keep(a / b);
}

fn root(a: f64) -> f64 {
    return keep(sqrt(a));
}
