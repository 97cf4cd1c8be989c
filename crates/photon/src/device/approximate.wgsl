// Surfaces whose random choices depend on functions that the device computes with errors of its own: roughness, and metals with a
// complex index. The results of such functions are compared with random numbers and are no part of a photon.

// Numbers closer than this to each other are compared by the CPU, if the device has computed them with an error of its own. The
// errors are below 1e-11 (see `metal_powers`) and below 1e-14 times the number (`roughness_rule`).
const MARGIN: f64 = 1e-9lf;

const SPECULAR: u32 = 0u;
const DIFFUSE: u32 = 1u;
const UNDECIDED: u32 = 2u;

// Whether the roughness of a surface makes a reflection diffuse: `Process::passes_roughness`, which compares a random number with
// exp(-phase^2). The logarithm of the number is compared with -phase^2 here.
fn roughness_rule(
    photon: Photon, normal: vec3<f64>, rest: f64, finish: Finish, stream: ptr<function, Stream>
) -> u32 {
    var facet = normal;
    if (finish.flags & IS_ROUGH) != 0u {
        facet = facet_normal(photon.direction, normal, finish, stream);
        if is_none(facet) {
            return UNDECIDED;
        }
    }
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

// A metal with a complex index: `Process::metal` behind `Process::use_complex_index`. The reflected powers are only compared with random
// numbers; a comparison that their errors could change is left to the CPU.
fn complex_metal(
    photon: Photon, normal: vec3<f64>, finish: Finish, pieces: u32, index: f64, stream: ptr<function, Stream>
) -> Photon {
    var changed = photon;
    let energy = photon.energy;
    let metal = vec2<f64>(piece_at(pieces + 24u, energy), piece_at(pieces + 28u, energy));
    let is_rough = (finish.flags & IS_ROUGH) != 0u;
    let is_unified = is_rough && (finish.flags & IS_UNIFIED) != 0u;
    for (var round = 0u; round < ROUNDS; round++) {
        if round > 0u {
            _ = uniform_(stream);
        }
        var facet = normal;
        if is_rough {
            facet = facet_normal(changed.direction, normal, finish, stream);
            if is_none(facet) {
                return handed_back(photon);
            }
        }
        let cosine = clamp(-dot64(changed.direction, facet), 0.0lf, 1.0lf);
        let powers = metal_powers(index, metal, cosine);
        let plane = cross64(changed.direction, facet);
        let plane_square = dot64(plane, plane);
        if powers.x < 0.0lf || (plane_square < 1e-200lf && plane_square > 0.0lf) {
            return handed_back(photon);
        }
        var fraction = 0.0lf;
        if plane_square > 0.0lf {
            let part = dot64(changed.polarisation, normalised(plane));
            fraction = part * part;
        }
        let s = powers.x * fraction;
        let p = powers.y * (1.0lf - fraction);
        let reflectivity = s + p;
        var reflects_s = false;
        var reflects_p = false;
        for (var turn = 0u; turn < ROUNDS && !reflects_s && !reflects_p; turn++) {
            let first = uniform_(stream) * reflectivity;
            let second = uniform_(stream) * reflectivity;
            if !(abs(first - s) > MARGIN && abs(second - p) > MARGIN) {
                return handed_back(photon);
            }
            reflects_s = first <= s;
            reflects_p = second <= p;
        }
        let u = uniform_(stream);
        let with_transmitted = reflectivity + select(0.0lf, piece_at(pieces + 4u, energy), round == 0u);
        let is_certain = abs(u - reflectivity) > MARGIN && abs(u - with_transmitted) > MARGIN;
        if !is_certain || !(reflects_s || reflects_p) {
            return handed_back(photon);
        }
        if u > with_transmitted {
            // a detected photon has the direction in which it arrived
            var lost = photon;
            let is_detected = uniform_(stream) < piece_at(pieces + 8u, energy);
            lost.event = select(ABSORPTION, DETECTION, is_detected);
            return lost;
        }
        if u > reflectivity {
            changed.event = TRANSMISSION;
            return changed;
        }
        if !is_unified {
            changed.event = select(SPIKE, LOBE, is_rough);
            changed = mirror(changed, facet);
        } else {
            if round == 0u {
                changed.event = chosen(finish, stream);
            }
            changed = off_complex_metal(changed, normal, facet, reflects_s, reflects_p, stream);
        }
        if changed.state == HANDED_BACK || dot64(changed.direction, normal) >= 0.0lf {
            return changed;
        }
    }
    return handed_back(photon);
}

// The reflection by a rough metal of the unified model: `Process::reflect_at_metal`, with the event that has been chosen.
fn off_complex_metal(
    photon: Photon, normal: vec3<f64>, facet: vec3<f64>, reflects_s: bool, reflects_p: bool,
    stream: ptr<function, Stream>
) -> Photon {
    var changed = photon;
    if photon.event == LAMBERTIAN {
        return diffuse(photon, normal, stream);
    }
    if photon.event == BACKSCATTER {
        changed.direction = -photon.direction;
        changed.polarisation = -photon.polarisation;
        return changed;
    }
    var about = normal;
    if photon.event == LOBE {
        about = facet;
    }
    let plane = cross64(photon.direction, about);
    changed = mirror(photon, about);
    let square = dot64(plane, plane);
    if square < 1e-200lf && square > 0.0lf {
        return handed_back(photon);
    }
    if square > 0.0lf && !(reflects_s && reflects_p) {
        let across_ = normalised(plane);
        if reflects_s {
            changed.polarisation = -across_;
        } else {
            changed.polarisation = -normalised(cross64(changed.direction, across_));
        }
    }
    return changed;
}
