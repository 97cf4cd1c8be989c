// The die in VecGeom: each call returns the distance to the next boundary, from outside or inside. A driver like those
// in Python: crates/bench/src/peers.rs defines the protocol.

#include <VecGeom/volumes/BooleanVolume.h>
#include <VecGeom/volumes/Box.h>
#include <VecGeom/volumes/LogicalVolume.h>
#include <VecGeom/volumes/Orb.h>
#include <VecGeom/volumes/PlacedVolume.h>
#include <VecGeom/volumes/Tube.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <time.h>
#include <vector>

using namespace vecgeom;
using Vec = Vector3D<Precision>;

template <BooleanOperation OP>
static VPlacedVolume const *combined(VPlacedVolume const *a, VPlacedVolume const *b)
{
  auto *solid = new UnplacedBooleanVolume<OP>(OP, a, b);
  return (new LogicalVolume("boolean", solid))->Place();
}

static VPlacedVolume const *bore(Transformation3D const &turn)
{
  auto *tube = GeoManager::MakeInstance<UnplacedTube>(0., 0.5, 2., 0., kTwoPi);
  return (new LogicalVolume("bore", tube))->Place(new Transformation3D(turn));
}

static VPlacedVolume const *die()
{
  auto *box  = (new LogicalVolume("box", GeoManager::MakeInstance<UnplacedBox>(1., 1., 1.)))->Place();
  auto *ball = (new LogicalVolume("ball", GeoManager::MakeInstance<UnplacedOrb>(1.35)))->Place();
  auto *core = combined<kIntersection>(box, ball);
  // Euler angles in degrees: about z, x, z
  core = combined<kSubtraction>(core, bore(Transformation3D(0, 0, 0, 90, 90, 0)));
  core = combined<kSubtraction>(core, bore(Transformation3D(0, 0, 0, 0, 90, 0)));
  return combined<kSubtraction>(core, bore(Transformation3D()));
}

struct Ray {
  Vec place, direction;
  double length;
};

static std::vector<double> full(VPlacedVolume const *solid, Ray const &ray)
{
  std::vector<double> times;
  Vec place = ray.place;
  double t  = 0;
  while (times.size() < 32) {
    double step = solid->DistanceToIn(place, ray.direction);
    if (step >= kInfLength) break;
    t += step;
    times.push_back(t / ray.length);
    place = ray.place + t * ray.direction;
    step  = solid->PlacedDistanceToOut(place, ray.direction);
    t += std::max(step, 0.);
    times.push_back(t / ray.length);
    place = ray.place + t * ray.direction;
  }
  return times;
}

// the list of a ray without its own memory: only this is timed
static double sum_of_all(VPlacedVolume const *solid, Ray const &ray)
{
  Vec place = ray.place;
  double t = 0, sum = 0;
  for (int i = 0; i < 16; ++i) {
    double step = solid->DistanceToIn(place, ray.direction);
    if (step >= kInfLength) break;
    t += step;
    sum += t;
    place = ray.place + t * ray.direction;
    step  = solid->PlacedDistanceToOut(place, ray.direction);
    t += std::max(step, 0.);
    sum += t;
    place = ray.place + t * ray.direction;
  }
  return sum;
}

// Arrays of float64 in row-major order, as the benchmark writes them.
static std::vector<double> load(std::string const &file, size_t &columns)
{
  std::ifstream in(file + ".npy", std::ios::binary);
  char head[10];
  if (!in.read(head, 10)) throw std::runtime_error("cannot read the rays");
  size_t length = static_cast<unsigned char>(head[8]) + 256 * static_cast<unsigned char>(head[9]);
  std::string text(length, ' ');
  in.read(&text[0], length);
  size_t at = text.find("(6, ");
  if (text.find("<f8") == std::string::npos || at == std::string::npos) throw std::runtime_error("no array of rays");
  columns = std::stoul(text.substr(at + 4));
  std::vector<double> values(6 * columns);
  in.read(reinterpret_cast<char *>(values.data()), 8 * values.size());
  return values;
}

static std::vector<Ray> rays(std::string const &file, size_t count)
{
  size_t columns;
  auto const v = load(file, columns);
  std::vector<Ray> all;
  for (size_t i = 0; i < std::min(count, columns); ++i) {
    Vec place(v[i], v[columns + i], v[2 * columns + i]);
    Vec direction(v[3 * columns + i], v[4 * columns + i], v[5 * columns + i]);
    double length = direction.Mag();
    all.push_back({place, direction / length, length});
  }
  return all;
}

static void save(std::string const &file, std::vector<std::vector<double>> const &lists)
{
  size_t rows = 1;
  for (auto const &list : lists)
    rows = std::max(rows, list.size());
  std::vector<double> table(rows * lists.size(), std::numeric_limits<double>::infinity());
  for (size_t i = 0; i < lists.size(); ++i)
    for (size_t row = 0; row < lists[i].size(); ++row)
      table[row * lists.size() + i] = lists[i][row];
  std::ostringstream text;
  text << "{'descr': '<f8', 'fortran_order': False, 'shape': (" << rows << ", " << lists.size() << "), }";
  std::string head = text.str();
  while ((head.size() + 11) % 64)
    head += ' ';
  head += '\n';
  std::ofstream out(file + ".npy", std::ios::binary);
  uint16_t length = head.size();
  out.write("\x93NUMPY\x01\x00", 8);
  out.write(reinterpret_cast<char const *>(&length), 2);
  out << head;
  out.write(reinterpret_cast<char const *>(table.data()), 8 * table.size());
}

// Seconds of the requested clock.
static double now()
{
  static char const *const clock = std::getenv("RAYWEAVE_BENCH_CLOCK");
  static bool const processor    = clock && std::string(clock) == "processor";
  timespec time;
  clock_gettime(processor ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &time);
  return time.tv_sec + 1e-9 * time.tv_nsec;
}

int main()
{
  auto const *solid = die();
  std::cout << "peer VecGeom 1.2 die.full die.first" << std::endl;
  std::string line, loaded;
  std::vector<Ray> batch;
  while (std::getline(std::cin, line)) {
    std::istringstream words(line);
    std::string verb, task, file, out;
    size_t count;
    words >> verb >> task >> file >> count >> out;
    try {
      std::string const wanted = file + " " + std::to_string(count);
      if (loaded != wanted) batch = rays(file, count);
      loaded = wanted;
      bool const all = task == "die.full";
      if (verb == "run") {
        double volatile sum = 0;
        double const started = now();
        for (auto const &ray : batch) {
          if (all) {
            sum = sum + sum_of_all(solid, ray);
          } else {
            double const t = solid->DistanceToIn(ray.place, ray.direction);
            Vec normal;
            if (t < kInfLength) solid->Normal(ray.place + t * ray.direction, normal);
            sum = sum + t;
          }
        }
        double const took = now() - started;
        std::cout << "seconds " << took << std::endl;
      } else {
        std::vector<std::vector<double>> lists;
        for (auto const &ray : batch) {
          auto list = full(solid, ray);
          if (!all && list.size() > 1) list.resize(1);
          lists.push_back(list);
        }
        save(out, lists);
        std::cout << "done" << std::endl;
      }
    } catch (std::exception const &error) {
      std::cout << "error " << error.what() << std::endl;
    }
  }
}
