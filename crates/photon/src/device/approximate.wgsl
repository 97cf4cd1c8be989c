// Surfaces whose random choices depend on functions that the device computes with errors of its own: roughness, and metals with a
// complex index. The results of such functions are compared with random numbers and are no part of a photon.

// Numbers closer than this to each other are compared by the CPU, if the device has computed them with an error of its own. The
// errors are below 1e-11 (see `metal_powers`) and below 1e-14 times the number (`roughness_rule`).
const MARGIN: f64 = 1e-9lf;

const SPECULAR: u32 = 0u;
const DIFFUSE: u32 = 1u;
// not a boundary event
const REFLECTED: u32 = 100u;
const UNDECIDED: u32 = 101u;

// Whether the roughness of a surface makes a reflection diffuse: `Process::passes_roughness`, which compares a random number with
// exp(-phase^2). The logarithm of the number is compared with -phase^2 here. `rest` is 4 pi times roughness and index.
fn roughness_rule(photon: Photon, facet: vec3<f64>, rest: f64, stream: ptr<function, Stream>) -> u32 {
    let phase = rest * -dot64(photon.direction, facet) * photon.energy / (@HC@lf * 1e-6lf);
    let square = phase * phase;
    let own = -log64(uniform_(stream));
    if !(abs(own - square) > MARGIN * (1.0lf + square)) {
        return UNDECIDED;
    }
    return select(DIFFUSE, SPECULAR, own > square);
}

// The powers that a metal reflects of the components s and p: those of `fresnel`, with a complex index. They need not have the bits of
// the CPU. With w = (n2 cos2)^2 = n2^2 - t^2 for the tangential component t, the relative error of w is a few units u = 2^-53 times
// (|n2|^2 + t^2) / |w|, at most 1e4. The real parts of both admittances are not negative, so that no denominator is smaller than its
// terms, and the errors of the powers are below 1e5 u. Negative numbers where that does not hold.
fn metal_powers(index: f64, metal: vec2<f64>, cosine: f64) -> vec2<f64> {
    let size = metal.x * metal.x + metal.y * metal.y;
    let tangential = index * index * max(1.0lf - cosine * cosine, 0.0lf);
    let square = vec2<f64>(metal.x * metal.x - metal.y * metal.y, 2.0lf * metal.x * metal.y);
    let w = vec2<f64>(square.x - tangential, square.y);
    let length = root(w.x * w.x + w.y * w.y);
    let is_certain = cosine > 1e-6lf && size > 1e-12lf && size < 1e12lf && length > 1e-4lf * (size + tangential);
    if !is_certain {
        return vec2<f64>(-1.0lf, -1.0lf);
    }
    // the root with parts that are not negative
    let large = root(0.5lf * (length + abs(w.x)));
    let small = 0.5lf * w.y / large;
    let is_propagating = w.x >= 0.0lf;
    let k = vec2<f64>(select(small, large, is_propagating), select(large, small, is_propagating));
    let s = index * cosine;
    let p = index / cosine;
    return vec2<f64>(
        reflected_power(vec2<f64>(s, 0.0lf), k),
        reflected_power(vec2<f64>(p * k.x, p * k.y), square),
    );
}

// |a - b|^2 / |a + b|^2
fn reflected_power(a: vec2<f64>, b: vec2<f64>) -> f64 {
    let less = vec2<f64>(a.x - b.x, a.y - b.y);
    let more = vec2<f64>(a.x + b.x, a.y + b.y);
    return (less.x * less.x + less.y * less.y) / (more.x * more.x + more.y * more.y);
}

// The choice of a metal with a complex index: REFLECTED, with the components that it reflects, a boundary event, or UNDECIDED.
struct Fate {
    way: u32,
    reflects_s: bool,
    reflects_p: bool,
}

// The random choices of `Process::metal_reflectivity` at a facet, and the loss behind them. The reflected powers are only compared with random
// numbers; a comparison that their errors could change is left to the CPU.
fn complex_fate(
    photon: Photon, facet: vec3<f64>, finish: Finish, index: f64, is_first: bool, stream: ptr<function, Stream>
) -> Fate {
    let energy = photon.energy;
    let pieces = finish.pieces;
    var fate = Fate(UNDECIDED, false, false);
    let metal = vec2<f64>(piece_at(pieces + 24u, energy), piece_at(pieces + 28u, energy));
    let cosine = clamp(-dot64(photon.direction, facet), 0.0lf, 1.0lf);
    let powers = metal_powers(index, metal, cosine);
    let plane = cross64(photon.direction, facet);
    let square = dot64(plane, plane);
    if powers.x < 0.0lf || (square < 1e-200lf && square > 0.0lf) {
        return fate;
    }
    var fraction = 0.0lf;
    if square > 0.0lf {
        let part = dot64(photon.polarisation, normalised(plane));
        fraction = part * part;
    }
    let s = powers.x * fraction;
    let p = powers.y * (1.0lf - fraction);
    let reflectivity = s + p;
    for (var turn = 0u; turn < ROUNDS && !fate.reflects_s && !fate.reflects_p; turn++) {
        let first = uniform_(stream) * reflectivity;
        let second = uniform_(stream) * reflectivity;
        if !(abs(first - s) > MARGIN && abs(second - p) > MARGIN) {
            return fate;
        }
        fate.reflects_s = first <= s;
        fate.reflects_p = second <= p;
    }
    let u = uniform_(stream);
    let with_transmitted = reflectivity + select(0.0lf, piece_at(pieces + 4u, energy), is_first);
    if !(abs(u - reflectivity) > MARGIN && abs(u - with_transmitted) > MARGIN && (fate.reflects_s || fate.reflects_p)) {
        return fate;
    }
    fate.way = REFLECTED;
    if u > with_transmitted {
        let is_detected = uniform_(stream) < piece_at(pieces + 8u, energy);
        fate.way = select(ABSORPTION, DETECTION, is_detected);
    } else if u > reflectivity {
        fate.way = TRANSMISSION;
    }
    return fate;
}

// The polarisation behind a reflection of one component: that of `Process::reflect_at_metal`. `plane` is the product of direction and facet.
fn polarised_by_metal(photon: Photon, plane: vec3<f64>, reflects_s: bool) -> Photon {
    var changed = photon;
    let square = dot64(plane, plane);
    if square == 0.0lf {
        return photon;
    }
    if square < 1e-200lf {
        return handed_back(photon);
    }
    let across_ = normalised(plane);
    if reflects_s {
        changed.polarisation = -across_;
    } else {
        changed.polarisation = -normalised(cross64(photon.direction, across_));
    }
    return changed;
}
