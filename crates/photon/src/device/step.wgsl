// The steps of photons: those of `batch.rs`, operation by operation. A photon that needs anything else, or whose next step is
// in doubt, is handed back to the CPU in the state before that step.

// 11 numbers of each photon: position, direction, polarisation, energy, time
@group(0) @binding(2) var<storage, read_write> numbers: array<f64>;
// 8 words of each photon: number (high, low), steps, state, start list
@group(0) @binding(3) var<storage, read_write> states: array<u32>;
// a row of 11 numbers and one of 10 words for each photon that comes back
@group(0) @binding(4) var<storage, read_write> back_numbers: array<f64>;
@group(0) @binding(5) var<storage, read_write> back_words: array<u32>;
// the number of rows, of photons in flight and of steps, then counts of ends and of boundary events
@group(0) @binding(6) var<storage, read_write> counts: array<atomic<u32>, @COUNTS@>;

@CODES@
// Rounds of rejection after which the CPU goes on.
const ROUNDS: u32 = 64u;

struct Photon {
    position: vec3<f64>,
    direction: vec3<f64>,
    polarisation: vec3<f64>,
    energy: f64,
    time: f64,
    number: vec2u,
    steps: u32,
    // the surfaces on which it starts: 0, or one more than twice the key of a surface, plus 1 inside of it
    starts: vec4u,
    // FLYING, a way of ending, or HANDED_BACK
    state: u32,
    // the last boundary event, the region behind it, and the face of that region, a facet of an item
    event: u32,
    after: u32,
    facet: u32,
    item: u32,
}

// The random numbers of a purpose in a step: `Stream`.
struct Stream {
    counter: vec4u,
    block: vec4u,
    used: u32,
}

fn philox(counter_: vec4u) -> vec4u {
    var counter = counter_;
    var key = params.seed;
    for (var round = 0u; round < 10u; round++) {
        if round > 0u {
            key += vec2u(0x9E3779B9u, 0xBB67AE85u);
        }
        let a = u64(0xD2511F53u) * u64(counter.x);
        let b = u64(0xCD9E8D57u) * u64(counter.z);
        counter = vec4u(
            u32(b >> 32u) ^ counter.y ^ key.x, u32(b), u32(a >> 32u) ^ counter.w ^ key.y, u32(a)
        );
    }
    return counter;
}

fn stream_of(photon: Photon, purpose: u32) -> Stream {
    return Stream(vec4u(photon.number, photon.steps, purpose << 24u), vec4u(), 4u);
}

fn uniform_of(high: u32, low: u32) -> f64 {
    let bits = (u64(high) << 21u) | u64(low >> 11u);
    return times_(plus(f64(bits), 0.5lf), @UNIT@lf);
}

fn uniform_(stream: ptr<function, Stream>) -> f64 {
    if (*stream).used >= 4u {
        (*stream).block = philox((*stream).counter);
        (*stream).counter.w += 1u;
        (*stream).used = 0u;
    }
    let block = (*stream).block;
    let at = (*stream).used;
    (*stream).used += 2u;
    return select(uniform_of(block.z, block.w), uniform_of(block.x, block.y), at == 0u);
}

// as `log` in `draws.rs`
fn log64(x: f64) -> f64 {
    let bits = bitcast<u64>(x) + @TO_ONE@lu;
    let power = f64(i32(u32(bits >> 52u)) - 0x3ff);
    let f = minus(bitcast<f64>((bits & 0x000ffffffffffffflu) + @ROOT@lu), 1.0lf);
    let half_square = times_(times_(0.5lf, f), f);
    let s = over(f, plus(2.0lf, f));
    let z = times_(s, s);
    let w = times_(z, z);
    let even = times_(w, plus(@LOG1@lf, times_(w, plus(@LOG3@lf, times_(w, @LOG5@lf)))));
    let odd = times_(z, plus(@LOG0@lf, times_(w, plus(@LOG2@lf, times_(w, plus(@LOG4@lf, times_(w, @LOG6@lf)))))));
    let low = plus(times_(s, plus(half_square, plus(odd, even))), times_(power, @LN2_LOW@lf));
    return plus(plus(minus(low, half_square), f), times_(power, @LN2_HIGH@lf));
}

// as `cos_sin_turns`
fn cos_sin(turns: f64) -> vec2<f64> {
    let four = times_(4.0lf, turns);
    let shifted = plus(four, 0.5lf);
    var quarters = 0u;
    for (var k = 1u; k <= 4u; k++) {
        quarters += select(0u, 1u, shifted >= f64(k));
    }
    let angle = times_(minus(four, f64(quarters)), @QUARTER@lf);
    let square = times_(angle, angle);
    var sine = @SIN6@lf;
    var cosine = @COS6@lf;
@SERIES@    let sin = plus(angle, times_(times_(angle, square), sine));
    let cos = minus(1.0lf, times_(square, minus(0.5lf, times_(square, cosine))));
    let is_even = (quarters & 1u) == 0u;
    let x = select(sin, cos, is_even);
    let y = select(cos, sin, is_even);
    return vec2<f64>(select(-x, x, ((quarters + 1u) & 2u) == 0u), select(-y, y, (quarters & 2u) == 0u));
}

fn normalised(v: vec3<f64>) -> vec3<f64> {
    return scaled64(over(1.0lf, root(dot64(v, v))), v);
}

fn cross64(a: vec3<f64>, b: vec3<f64>) -> vec3<f64> {
    return vec3<f64>(
        minus(times_(a.y, b.z), times_(b.y, a.z)),
        minus(times_(a.z, b.x), times_(b.z, a.x)),
        minus(times_(a.x, b.y), times_(b.x, a.y)),
    );
}

// as `Stream::around`, with the azimuth in turns
fn around(axis: vec3<f64>, cosine: f64, turns: f64) -> vec3<f64> {
    let sine = root(max(minus(1.0lf, times_(cosine, cosine)), 0.0lf));
    let turn = cos_sin(turns);
    let is_negative = (bitcast<u64>(axis.z) >> 63u) == 1lu;
    let sign = select(1.0lf, -1.0lf, is_negative);
    let a = over(-1.0lf, plus(sign, axis.z));
    let b = times_(times_(axis.x, axis.y), a);
    let x = vec3<f64>(
        plus(1.0lf, times_(times_(times_(sign, axis.x), axis.x), a)), times_(sign, b), times_(-sign, axis.x)
    );
    let y = vec3<f64>(b, plus(sign, times_(times_(axis.y, axis.y), a)), -axis.y);
    let across_ = sum64(scaled64(turn.x, x), scaled64(turn.y, y));
    return normalised(sum64(scaled64(sine, across_), scaled64(cosine, axis)));
}

fn mirrored(v: vec3<f64>, n: vec3<f64>) -> vec3<f64> {
    return difference64(v, scaled64(times_(2.0lf, dot64(v, n)), n));
}

// A vector of nearly unit length; zero if it is not.
fn renormalised(v: vec3<f64>) -> vec3<f64> {
    let square = dot64(v, v);
    if !(abs(minus(square, 1.0lf)) < 1e-8lf) {
        return vec3<f64>();
    }
    return scaled64(minus(1.5lf, times_(0.5lf, square)), v);
}

// The number of energies up to the given one, of `count` in ascending order: `interval`.
fn interval(at: u32, count: u32, x: f64) -> u32 {
    var low = 0u;
    var high = count;
    while low < high {
        let middle = (low + high) / 2u;
        if exact[at + middle] <= x {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    return low;
}

// as `Piece::at`: start, width, value, rise
fn piece_at(at: u32, energy: f64) -> f64 {
    let rise = exact[at + 3u];
    if rise == 0.0lf {
        return plus(exact[at + 2u], 0.0lf);
    }
    return plus(exact[at + 2u], times_(rise, over(minus(energy, exact[at]), exact[at + 1u])));
}

// The numbers of the pieces of some properties at an energy. The row: energies, their number, pieces, number of properties.
fn pieces_of(row: u32, energy: f64) -> u32 {
    let first = interval(words[row], words[row + 1u], energy);
    return words[row + 2u] + 4u * first * words[row + 3u];
}

// Linear interpolation: `interpolate`.
fn interpolated(xs: u32, ys: u32, count: u32, x: f64) -> f64 {
    let after = interval(xs, count, x);
    if after == 0u {
        return exact[ys];
    }
    let b = ys + after;
    if after == count {
        return exact[b - 1u];
    }
    let a = xs + after;
    let part = over(minus(x, exact[a - 1u]), minus(exact[a], exact[a - 1u]));
    return plus(exact[b - 1u], times_(minus(exact[b], exact[b - 1u]), part));
}

const MATERIALS: u32 = @MATERIALS@;
const MATERIAL_OF: u32 = @MATERIAL_OF@;
const PAIRS: u32 = @PAIRS@;
const REGIONS: u32 = @REGIONS@;
const SURFACES: u32 = @SURFACES@;

// The row of a material: four words of its properties (index, velocity and paths), 1 if it has an index, number of processes, their
// kinds, rows of shifters.
fn material_row(region: u32) -> u32 {
    return MATERIALS + MATERIAL_WORDS * words[MATERIAL_OF + region];
}

fn handed_back(photon: Photon) -> Photon {
    var changed = photon;
    changed.state = HANDED_BACK;
    return changed;
}

fn ended(photon: Photon, way: u32) -> Photon {
    var changed = photon;
    changed.state = way;
    return changed;
}

// as `scatter::rayleigh`
fn rayleigh(photon: Photon) -> Photon {
    var stream = stream_of(photon, SCATTERING);
    var changed = photon;
    for (var round = 0u; round < ROUNDS; round++) {
        let cosine = minus(times_(2.0lf, uniform_(&stream)), 1.0lf);
        let scattered = around(photon.direction, cosine, uniform_(&stream));
        let turned = turned_(photon.polarisation, scattered, &stream);
        if is_none(turned) {
            return handed_back(photon);
        }
        let overlap = dot64(turned, photon.polarisation);
        if times_(overlap, overlap) >= uniform_(&stream) {
            changed.direction = scattered;
            changed.polarisation = turned;
            return changed;
        }
    }
    return handed_back(photon);
}

// The part of a polarisation perpendicular to a new direction, of random sign: `scatter::turned`; zero if the CPU has to choose it.
fn turned_(polarisation: vec3<f64>, direction: vec3<f64>, stream: ptr<function, Stream>) -> vec3<f64> {
    let rest = difference64(polarisation, scaled64(dot64(polarisation, direction), direction));
    if !(dot64(rest, rest) > 1e-200lf) {
        return vec3<f64>();
    }
    let turned = normalised(rest);
    return select(turned, -turned, uniform_(stream) < 0.5lf);
}

// as `scatter::mie`. The numbers: mean cosine forward and backward, probability of the forward lobe.
fn mie(photon: Photon, at: u32) -> Photon {
    var stream = stream_of(photon, SCATTERING);
    var changed = photon;
    let is_forward = uniform_(&stream) <= exact[at + 2u];
    let g = select(exact[at + 1u], exact[at], is_forward);
    let u = uniform_(&stream);
    var cosine = minus(times_(2.0lf, u), 1.0lf);
    if g != 0.0lf {
        let double_g = times_(2.0lf, g);
        let ratio = plus(minus(1.0lf, g), times_(double_g, u));
        let more = plus(1.0lf, g);
        let rest = plus(minus(1.0lf, g), times_(g, u));
        let product = times_(times_(times_(times_(2.0lf, u), more), more), rest);
        cosine = clamp(minus(over(product, times_(ratio, ratio)), 1.0lf), -1.0lf, 1.0lf);
    }
    changed.direction = around(photon.direction, select(-cosine, cosine, is_forward), uniform_(&stream));
    changed.polarisation = turned_(photon.polarisation, changed.direction, &stream);
    if is_none(changed.polarisation) {
        return handed_back(photon);
    }
    return changed;
}

// as `Batch::shift` for one photon. The row: energies, cumulative distribution, their number, time.
fn shifted(photon: Photon, row: u32) -> Photon {
    var stream = stream_of(photon, REEMISSION);
    var changed = photon;
    let fraction = uniform_(&stream);
    let total = interpolated(words[row], words[row + 1u], words[row + 2u], photon.energy);
    if !(total > 0.0lf) {
        return handed_back(photon);
    }
    changed.energy = interpolated(words[row + 1u], words[row], words[row + 2u], times_(fraction, total));
    let z = minus(times_(2.0lf, uniform_(&stream)), 1.0lf);
    changed.direction = around(vec3<f64>(0.0lf, 0.0lf, 1.0lf), z, uniform_(&stream));
    changed.polarisation = around(changed.direction, 0.0lf, uniform_(&stream));
    var delay = exact[words[row + 3u]];
    if (params.rules & EXPONENTIAL) != 0u {
        delay = times_(delay, -log64(uniform_(&stream)));
    }
    changed.time = plus(photon.time, delay);
    return changed;
}

// The shortest free path, if it ends before the boundary, and its process: `free_path`.
struct FreePath {
    length: f64,
    process: u32,
}

fn free_path(photon: Photon, material: u32, paths: u32, to_boundary: f64) -> FreePath {
    var shortest = FreePath(FAR, 0u);
    var stream = stream_of(photon, FREE_PATH);
    for (var k = 0u; k < words[material + 5u]; k++) {
        let mean = piece_at(paths + 4u * k, photon.energy);
        let u = uniform_(&stream);
        // most paths are certainly longer
        if times_(times_(mean, minus(1.0lf, u)), @LEAST@lf) > to_boundary {
            continue;
        }
        let length = times_(mean, -log64(u));
        if length < shortest.length {
            shortest = FreePath(length, k);
        }
    }
    return shortest;
}

// The properties of a surface for the process: the probabilities of the reflections of the unified model, the value, 4 pi times the roughness,
// whether it makes a reflection diffuse, and the place of the properties. Without a surface the interface is smooth.
struct Finish {
    flags: u32,
    is_diffuse: bool,
    value: f64,
    roughness: f64,
    lobe: f64,
    spike: f64,
    backscatter: f64,
    pieces: u32,
}

// The boundary process: `Boundary::apply`. `entry` is that of the pair of regions, with the surface, if there is one, above bit 3.
// The row of a surface: its properties (four words), the place of its value and of 4 pi times its roughness, flags.
fn meet(photon: Photon, normal: vec3<f64>, entry: u32, index: f64, after: u32) -> Photon {
    var changed = photon;
    let kind = entry & KIND_BITS;
    if kind == SAME {
        changed.event = SAME_MATERIAL;
        return left(changed, normal);
    }
    let behind_row = material_row(after);
    if kind == INTERFACE && words[behind_row + 4u] == 0u {
        changed.event = INDEX_MISSING;
        return changed;
    }
    var stream = stream_of(photon, BOUNDARY);
    var finish = Finish(0u, false, 0.0lf, 0.0lf, 0.0lf, 0.0lf, 0.0lf, 0u);
    let has_surface = (entry >> SURFACE_SHIFT) != 0u;
    if has_surface {
        let row = SURFACES + SURFACE_WORDS * ((entry >> SURFACE_SHIFT) - 1u);
        let pieces = pieces_of(row, photon.energy);
        let value = words[row + 4u];
        finish = Finish(
            words[row + 5u], false, exact[value], exact[value + 1u], piece_at(pieces + 12u, photon.energy),
            piece_at(pieces + 16u, photon.energy), piece_at(pieces + 20u, photon.energy), pieces
        );
    }
    let is_complex = kind == COMPLEX_METAL;
    // a metal with a complex index has its losses behind the choice of the facet
    if !is_complex {
        let u = uniform_(&stream);
        if has_surface {
            let pieces = finish.pieces;
            let reflectivity = piece_at(pieces, photon.energy);
            if u > plus(reflectivity, piece_at(pieces + 4u, photon.energy)) {
                let is_detected = uniform_(&stream) < piece_at(pieces + 8u, photon.energy);
                changed.event = select(ABSORPTION, DETECTION, is_detected);
                return changed;
            }
            if u > reflectivity {
                changed.event = TRANSMISSION;
                return left(changed, normal);
            }
        }
    }
    switch kind {
        case INTERFACE: {
            let behind = piece_at(pieces_of(behind_row, photon.energy), photon.energy);
            changed = interface_(photon, normal, vec2<f64>(index, behind), finish, &stream);
        }
        case MIRROR: {
            changed.event = SPIKE;
            changed = mirror(changed, normal);
        }
        case PAINT: {
            changed.event = LAMBERTIAN;
            changed = diffuse(changed, normal, &stream);
        }
        case METAL, COMPLEX_METAL: {
            changed = metal(photon, normal, finish, select(0.0lf, index, is_complex), &stream);
            if changed.event == ABSORPTION || changed.event == DETECTION {
                return changed;
            }
        }
        default: {
            return handed_back(photon);
        }
    }
    return left(changed, normal);
}

// as `Process::mirror`
fn mirror(photon: Photon, facet: vec3<f64>) -> Photon {
    var changed = photon;
    changed.direction = mirrored(photon.direction, facet);
    changed.polarisation = -mirrored(photon.polarisation, facet);
    return changed;
}

// Diffuse reflection: `Stream::lambertian` and `Process::leave_along`.
fn diffuse(photon: Photon, normal: vec3<f64>, stream: ptr<function, Stream>) -> Photon {
    var changed = photon;
    let cosine = root(uniform_(stream));
    changed.direction = around(normal, cosine, uniform_(stream));
    let half = difference64(changed.direction, photon.direction);
    if !(dot64(half, half) > 1e-200lf) {
        return handed_back(photon);
    }
    changed.polarisation = -mirrored(photon.polarisation, normalised(half));
    return changed;
}

// The event of a reflection by a rough surface of the unified model: `Process::choose_reflection`.
fn chosen(finish: Finish, stream: ptr<function, Stream>) -> u32 {
    let u = uniform_(stream);
    let mirrors = plus(finish.spike, finish.lobe);
    if u < finish.spike {
        return SPIKE;
    }
    if u < mirrors {
        return LOBE;
    }
    return select(LAMBERTIAN, BACKSCATTER, u < plus(mirrors, finish.backscatter));
}

// as `sin` and `cos` in `libm`, for angles from 2^-26 to a quarter of pi
fn small_sine(x: f64) -> f64 {
    let z = times_(x, x);
    let w = times_(z, z);
    let r = plus(
        plus(@S2@lf, times_(z, plus(@S3@lf, times_(z, @S4@lf)))),
        times_(times_(z, w), plus(@S5@lf, times_(z, @S6@lf)))
    );
    return plus(x, times_(times_(z, x), plus(@S1@lf, times_(z, r))));
}

fn small_cosine(x: f64) -> f64 {
    let z = times_(x, x);
    let w = times_(z, z);
    let r = plus(
        times_(z, plus(@C1@lf, times_(z, plus(@C2@lf, times_(z, @C3@lf))))),
        times_(times_(w, w), plus(@C4@lf, times_(z, plus(@C5@lf, times_(z, @C6@lf)))))
    );
    let half = times_(0.5lf, z);
    let whole = minus(1.0lf, half);
    return plus(whole, plus(minus(minus(1.0lf, whole), half), times_(z, r)));
}

// The normal of a microfacet that a direction can reach: `Process::facet_normal`; zero if the CPU has to choose it.
fn facet_normal(d: vec3<f64>, normal: vec3<f64>, finish: Finish, stream: ptr<function, Stream>) -> vec3<f64> {
    if (finish.flags & IS_UNIFIED) == 0u {
        return facet_in_ball(d, normal, finish, stream);
    }
    let sigma = finish.value;
    if sigma == 0.0lf {
        return normal;
    }
    let bound = min(times_(4.0lf, sigma), 1.0lf);
    for (var round = 0u; round < ROUNDS; round++) {
        let radius = root(times_(2.0lf, -log64(uniform_(stream))));
        let alpha = times_(sigma, times_(radius, cos_sin(uniform_(stream)).x));
        let u = uniform_(stream);
        if alpha >= @QUARTER@lf || (alpha < 0.0lf && alpha > -3.0lf) {
            // too steep, or the sine is negative
            continue;
        }
        if !(alpha > 2e-8lf && alpha < 0.785lf) {
            return vec3<f64>();
        }
        if times_(u, bound) > small_sine(alpha) {
            continue;
        }
        let facet = around(normal, small_cosine(alpha), uniform_(stream));
        if dot64(d, facet) < 0.0lf {
            return facet;
        }
    }
    return vec3<f64>();
}

fn facet_in_ball(d: vec3<f64>, normal: vec3<f64>, finish: Finish, stream: ptr<function, Stream>) -> vec3<f64> {
    let polish = finish.value;
    if polish >= 1.0lf {
        return normal;
    }
    for (var round = 0u; round < ROUNDS; round++) {
        let x = minus(times_(2.0lf, uniform_(stream)), 1.0lf);
        let y = minus(times_(2.0lf, uniform_(stream)), 1.0lf);
        let z = minus(times_(2.0lf, uniform_(stream)), 1.0lf);
        let smear = vec3<f64>(x, y, z);
        let facet = sum64(normal, scaled64(minus(1.0lf, polish), smear));
        if dot64(smear, smear) <= 1.0lf && dot64(d, facet) < 0.0lf {
            return normalised(facet);
        }
    }
    return vec3<f64>();
}

fn is_none(facet: vec3<f64>) -> bool {
    return dot64(facet, facet) < 0.5lf;
}

// A dielectric in front of a metal: `Process::metal` behind its first random number or, with the index in front of a metal with a complex
// index, behind `Process::use_complex_index`; the index is 0 for a metal with a given reflectivity.
fn metal(photon: Photon, normal: vec3<f64>, finish: Finish, index: f64, stream: ptr<function, Stream>) -> Photon {
    var changed = photon;
    let is_complex = index > 0.0lf;
    let is_rough = (finish.flags & IS_ROUGH) != 0u;
    let is_unified = is_rough && (finish.flags & IS_UNIFIED) != 0u;
    for (var round = 0u; round < ROUNDS; round++) {
        if round > 0u {
            _ = uniform_(stream);
        }
        if !is_unified {
            changed.event = select(SPIKE, LOBE, is_rough);
        } else if round == 0u && !is_complex {
            changed.event = chosen(finish, stream);
        }
        var facet = normal;
        if changed.event == LOBE || (is_complex && is_rough) {
            facet = facet_normal(changed.direction, normal, finish, stream);
            if is_none(facet) {
                return handed_back(photon);
            }
        }
        var fate = Fate(REFLECTED, true, true);
        if is_complex {
            fate = complex_fate(changed, facet, finish, index, round == 0u, stream);
            if fate.way == UNDECIDED {
                return handed_back(photon);
            }
            if fate.way != REFLECTED {
                // a detected photon has the direction in which it arrived
                var lost = photon;
                lost.event = fate.way;
                return lost;
            }
            if is_unified && round == 0u {
                changed.event = chosen(finish, stream);
            }
            // the facet of the reflectivity is that of the lobe only
            if changed.event != LOBE {
                facet = normal;
            }
        }
        switch changed.event {
            case LAMBERTIAN: {
                changed = diffuse(changed, normal, stream);
            }
            case BACKSCATTER: {
                changed.direction = -changed.direction;
                changed.polarisation = -changed.polarisation;
            }
            default: {
                let before = changed.direction;
                changed = mirror(changed, facet);
                if is_unified && !(fate.reflects_s && fate.reflects_p) {
                    changed = polarised_by_metal(changed, cross64(before, facet), fate.reflects_s);
                }
            }
        }
        if changed.state == HANDED_BACK || dot64(changed.direction, normal) >= 0.0lf {
            return changed;
        }
    }
    return handed_back(photon);
}

// An interface between two dielectrics: `Process::interface`, without paint behind it.
fn interface_(
    photon: Photon, normal_: vec3<f64>, indices_: vec2<f64>, finish_: Finish, stream: ptr<function, Stream>
) -> Photon {
    var changed = photon;
    var normal = normal_;
    var indices = indices_;
    var is_through = false;
    var finish = finish_;
    // the first facet decides whether the roughness makes reflections diffuse
    var decides = (finish.flags & HAS_ROUGHNESS) != 0u && indices.x > indices.y;
    for (var round = 0u; round < ROUNDS; round++) {
        if is_through {
            normal = -normal;
            indices = indices.yx;
        }
        var facet = normal;
        if (finish.flags & IS_ROUGH) != 0u {
            facet = facet_normal(changed.direction, normal, finish, stream);
            if is_none(facet) {
                return handed_back(photon);
            }
        }
        if decides {
            decides = false;
            let diffuse_ = roughness_rule(photon, facet, finish.roughness * indices.x, stream);
            if diffuse_ == UNDECIDED {
                return handed_back(photon);
            }
            finish.is_diffuse = diffuse_ == DIFFUSE;
            continue;
        }
        changed = at_facet(changed, normal, facet, indices, finish, stream);
        if changed.state == HANDED_BACK {
            return changed;
        }
        is_through = changed.event == REFRACTION;
        let rise = dot64(changed.direction, normal);
        if (is_through && rise <= 0.0lf) || (!is_through && rise >= -@GRAZING@lf) {
            return changed;
        }
    }
    return handed_back(photon);
}

// After the process: the vectors of unit length. Photons along the surface are handed back.
fn left(photon: Photon, normal: vec3<f64>) -> Photon {
    var changed = photon;
    changed.direction = renormalised(photon.direction);
    changed.polarisation = renormalised(photon.polarisation);
    let is_unit = dot64(changed.direction, changed.direction) > 0.5lf
        && dot64(changed.polarisation, changed.polarisation) > 0.5lf;
    if photon.state == HANDED_BACK || !is_unit || !(abs(dot64(changed.direction, normal)) > 1e-9lf) {
        return handed_back(photon);
    }
    return changed;
}

// One event at one facet: `Process::refract_or_reflect`.
fn at_facet(
    photon: Photon, normal: vec3<f64>, facet_: vec3<f64>, indices: vec2<f64>, finish: Finish, stream: ptr<function, Stream>
) -> Photon {
    var changed = photon;
    var facet = facet_;
    let index = indices.x;
    let behind = indices.y;
    let d = photon.direction;
    let cosine = -dot64(d, facet);
    let is_oblique = abs(cosine) < @OBLIQUE@lf;
    var sin1 = 0.0lf;
    if is_oblique {
        sin1 = root(minus(1.0lf, times_(cosine, cosine)));
    }
    let sin2 = over(times_(sin1, index), behind);
    if sin2 >= 1.0lf {
        changed.event = TOTAL_REFLECTION;
        changed = by_kind(changed, normal, finish, stream);
        if changed.event == LAMBERTIAN || changed.event == BACKSCATTER || changed.state == HANDED_BACK {
            return changed;
        }
        if changed.event == SPIKE {
            facet = normal;
        }
        return mirror(changed, facet);
    }
    let cosine2 = root(minus(1.0lf, times_(sin2, sin2)));
    var across_ = photon.polarisation;
    var s = 0.0lf;
    var p = 1.0lf;
    if is_oblique {
        across_ = normalised(cross64(d, facet));
        s = dot64(photon.polarisation, across_);
        let rest = difference64(photon.polarisation, scaled64(s, across_));
        p = root(dot64(rest, rest));
    }
    let flux = times_(times_(2.0lf, index), cosine);
    let s2 = over(times_(flux, s), plus(times_(index, cosine), times_(behind, cosine2)));
    let p2 = over(times_(flux, p), plus(times_(behind, cosine), times_(index, cosine2)));
    let power = plus(times_(s2, s2), times_(p2, p2));
    let transmitted = over(times_(times_(behind, cosine2), power), times_(index, cosine));
    var amplitudes = vec2<f64>(s2, p2);
    if uniform_(stream) < transmitted {
        changed.event = REFRACTION;
        if !is_oblique {
            return changed;
        }
        let bend = minus(cosine, times_(cosine2, over(behind, index)));
        changed.direction = normalised(sum64(d, scaled64(bend, facet)));
    } else {
        changed.event = REFLECTION;
        changed = by_kind(changed, normal, finish, stream);
        if changed.event == LAMBERTIAN || changed.event == BACKSCATTER || changed.state == HANDED_BACK {
            return changed;
        }
        if changed.event == SPIKE {
            facet = normal;
        }
        changed.direction = mirrored(d, facet);
        if !is_oblique {
            if behind > index {
                changed.polarisation = -photon.polarisation;
            }
            return changed;
        }
        amplitudes = vec2<f64>(minus(s2, s), minus(over(times_(behind, p2), index), p));
    }
    let along = normalised(cross64(changed.direction, across_));
    let sum = sum64(scaled64(amplitudes.y, along), scaled64(amplitudes.x, across_));
    let size = root(plus(times_(amplitudes.x, amplitudes.x), times_(amplitudes.y, amplitudes.y)));
    changed.polarisation = vec3<f64>(over(sum.x, size), over(sum.y, size), over(sum.z, size));
    return changed;
}

// The kind of a reflection, with diffuse reflection and backscattering: `Process::is_reflected_like_a_facet`.
fn by_kind(photon: Photon, normal: vec3<f64>, finish: Finish, stream: ptr<function, Stream>) -> Photon {
    var changed = photon;
    if finish.is_diffuse {
        changed.event = LAMBERTIAN;
    }
    if (finish.flags & (IS_ROUGH | IS_UNIFIED)) == (IS_ROUGH | IS_UNIFIED) {
        changed.event = chosen(finish, stream);
    }
    if changed.event == LAMBERTIAN {
        return diffuse(changed, normal, stream);
    }
    if changed.event == BACKSCATTER {
        changed.direction = -photon.direction;
        changed.polarisation = -photon.polarisation;
    }
    return changed;
}

// The boundary at the end of a step: `Batch::boundary`.
fn at_boundary(photon: Photon, line: Line, next: Next, index: f64) -> Photon {
    let entry = words[PAIRS + REGIONS * next.before + next.after];
    if (entry & KIND_BITS) == UNKNOWN {
        return handed_back(photon);
    }
    let key = words[ITEM_ROWS + 5u * next.item + 3u] + words[FACET_ROWS + 5u * next.facet + 3u];
    let touched = touch(line, next.t, next.facet, next.item);
    if !touched.is_certain {
        return handed_back(photon);
    }
    var changed = meet(photon, touched.normal, entry, index, next.after);
    if changed.state == HANDED_BACK {
        return changed;
    }
    changed.position = touched.position;
    changed.after = next.after;
    changed.facet = next.entered_facet;
    changed.item = next.entered_item;
    switch changed.event {
        case DETECTION: {
            return ended(changed, select(SURFACE_ABSORBED, DETECTED, (params.rules & BY_EFFICIENCY) != 0u));
        }
        case ABSORPTION: {
            return ended(changed, SURFACE_ABSORBED);
        }
        case INDEX_MISSING: {
            return ended(changed, NO_INDEX);
        }
        default: {}
    }
    let is_behind = dot64(changed.direction, touched.normal) < 0.0lf;
    if is_behind && (entry & SENSITIVE) != 0u && (params.rules & BY_VOLUME) != 0u {
        return ended(changed, DETECTED);
    }
    let inside = (touched.slope < 0.0lf) == is_behind;
    let starts = starts_at(line, next.t, 2u * key + 1u + select(0u, 1u, inside), is_behind);
    if !starts.certain {
        return handed_back(photon);
    }
    changed.starts = starts.list;
    return changed;
}

// One step: `Batch::advance` and `Batch::conclude`.
fn step(before: Photon) -> Photon {
    var photon = before;
    photon.event = NO_EVENT;
    let line = Line(photon.position, photon.direction);
    let next = next_crossing(line, photon.starts);
    if next.route == DOUBT {
        return handed_back(before);
    }
    if next.route == NOTHING && next.before == 0u {
        return ended(photon, ESCAPED);
    }
    if next.route == NOTHING {
        return handed_back(before);
    }
    if photon.steps >= params.max_steps {
        return ended(photon, STEP_LIMIT);
    }
    let material = material_row(next.before);
    if words[material + 4u] == 0u {
        return ended(photon, NO_INDEX);
    }
    photon.steps += 1u;
    let pieces = pieces_of(material, photon.energy);
    let velocity = piece_at(pieces + 4u, photon.energy);
    let free = free_path(photon, material, pieces + 8u, next.t);
    let length = min(free.length, next.t);
    photon.time = plus(photon.time, over(length, velocity));
    if photon.time > bitcast<f64>((u64(params.max_time.y) << 32u) | u64(params.max_time.x)) {
        return ended(photon, TIME_LIMIT);
    }
    if !(free.length < next.t) {
        if next.after == 0u {
            return ended(photon, ESCAPED);
        }
        let moved_on = at_boundary(photon, line, next, piece_at(pieces, photon.energy));
        if moved_on.state == HANDED_BACK {
            return handed_back(before);
        }
        return moved_on;
    }
    photon.starts = vec4u();
    photon.position = at_time(line, length);
    let process = (words[material + 6u] >> (PROCESS_BITS * free.process)) & OTHER_PROCESS;
    switch process {
        case ABSORBS: {
            return ended(photon, ABSORBED);
        }
        case RAYLEIGH: {
            photon = rayleigh(photon);
        }
        case MIE: {
            photon = mie(photon, words[material + 9u]);
        }
        case SHIFTS, SHIFTS_AGAIN: {
            photon = shifted(photon, words[material + 7u + process - SHIFTS]);
        }
        default: {
            return handed_back(before);
        }
    }
    if photon.state == HANDED_BACK {
        return handed_back(before);
    }
    return photon;
}

fn vector_of(at: u32) -> vec3<f64> {
    return vec3<f64>(numbers[at], numbers[at + 1u], numbers[at + 2u]);
}

fn photon_of(i: u32) -> Photon {
    let n = 11u * i;
    let w = 8u * i;
    return Photon(
        vector_of(n), vector_of(n + 3u), vector_of(n + 6u), numbers[n + 9u], numbers[n + 10u],
        vec2u(states[w], states[w + 1u]), states[w + 2u],
        vec4u(states[w + 4u], states[w + 5u], states[w + 6u], states[w + 7u]), states[w + 3u], NO_EVENT, 0u, 0u, 0u,
    );
}

fn keep_photon(i: u32, photon: Photon) {
    let n = 11u * i;
    for (var k = 0u; k < 3u; k++) {
        numbers[n + k] = photon.position[k];
        numbers[n + 3u + k] = photon.direction[k];
        numbers[n + 6u + k] = photon.polarisation[k];
    }
    numbers[n + 9u] = photon.energy;
    numbers[n + 10u] = photon.time;
    states[8u * i + 2u] = photon.steps;
    states[8u * i + 3u] = photon.state;
    for (var k = 0u; k < 4u; k++) {
        states[8u * i + 4u + k] = photon.starts[k];
    }
}

fn send_back(i: u32, photon: Photon) {
    let row = atomicAdd(&counts[0], 1u);
    for (var k = 0u; k < 3u; k++) {
        back_numbers[11u * row + k] = photon.position[k];
        back_numbers[11u * row + 3u + k] = photon.direction[k];
        back_numbers[11u * row + 6u + k] = photon.polarisation[k];
    }
    back_numbers[11u * row + 9u] = photon.energy;
    back_numbers[11u * row + 10u] = photon.time;
    let w = 10u * row;
    back_words[w] = i;
    back_words[w + 1u] = photon.state;
    back_words[w + 2u] = photon.steps;
    back_words[w + 3u] = photon.after;
    back_words[w + 4u] = photon.facet;
    back_words[w + 5u] = photon.item;
    for (var k = 0u; k < 4u; k++) {
        back_words[w + 6u + k] = photon.starts[k];
    }
}

var<workgroup> tallies: array<atomic<u32>, @COUNTS@>;

// Some steps of a photon.
fn fly(i: u32) {
    if states[8u * i + 3u] != FLYING {
        return;
    }
    var photon = photon_of(i);
    let steps = photon.steps;
    for (var k = 0u; k < params.most && photon.state == FLYING; k++) {
        photon = step(photon);
        if photon.event != NO_EVENT && photon.state != HANDED_BACK {
            atomicAdd(&tallies[FIRST_EVENT_COUNT + photon.event], 1u);
        }
    }
    atomicAdd(&tallies[2], photon.steps - steps);
    keep_photon(i, photon);
    if photon.state == FLYING {
        atomicAdd(&tallies[1], 1u);
        return;
    }
    atomicAdd(&tallies[2u + photon.state], 1u);
    if photon.state == DETECTED || photon.state == HANDED_BACK || (params.rules & ALL) != 0u {
        send_back(i, photon);
    }
}
