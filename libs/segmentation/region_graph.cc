#include "segmentation/region_graph.h"

#include <tsl/robin_map.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "base/parallel.h"
#include "segmentation/at.h"

namespace vismap {
namespace {

/// Sums over the pixels of a run: of inverse depth w, of the ray's x, of their products, and of the
/// normals. The ray's y is the same for all of them.
struct RunSums {
  double w = 0, xw = 0, ww = 0, variance = 0, x = 0, xx = 0;
  double nx = 0, ny = 0, nz = 0;
};

RunSums SumRun(const SurfaceMap& surface, const PinholeCamera& camera, const Run& run) {
  const float* z = surface.points_C.z.row(run.v);
  const float* depth_sigma = surface.depth_sigma.row(run.v);
  const float *nx = surface.normals_C.x.row(run.v), *ny = surface.normals_C.y.row(run.v),
              *nz = surface.normals_C.z.row(run.v);
  const double inv_fx = 1 / camera.fx;
  RunSums sums;
  for (int u = run.begin; u < run.end; ++u) {
    const double w = 1.0 / z[u], x = (u - camera.cx) * inv_fx, sigma = depth_sigma[u] * w * w;
    sums.w += w;
    sums.xw += x * w;
    sums.ww += w * w;
    sums.variance += sigma * sigma;
    sums.x += x;
    sums.xx += x * x;
    const bool known = nz[u] == nz[u];  // not NaN
    sums.nx += known ? nx[u] : 0.0F;
    sums.ny += known ? ny[u] : 0.0F;
    sums.nz += known ? nz[u] : 0.0F;
  }
  return sums;
}

void AddRun(const RunSums& sums, double y, double count, PlaneMoments* m) {
  m->aa(0, 0) += sums.xx;
  m->aa(0, 1) += sums.x * y;
  m->aa(1, 1) += count * y * y;
  m->aa(0, 2) += sums.x;
  m->aa(1, 2) += count * y;
  m->aa(2, 2) += count;
  m->aw += Eigen::Vector3d(sums.xw, y * sums.w, sums.w);
  m->ww += sums.ww;
  m->variance += sums.variance;
}

void Measure(const SurfaceMap& surface, const PinholeCamera& camera, int32_t count,
             RegionGraph* graph) {
  const std::vector<Run>& runs = graph->runs.runs();
  std::vector<RunSums> sums(runs.size());
  ParallelFor(runs.size(), 256, [&](size_t i) { sums[i] = SumRun(surface, camera, runs[i]); });
  graph->moments.resize(At(count) + 1);
  graph->normals.resize(At(count) + 1, Eigen::Vector3d::Zero());
  graph->pixels.resize(At(count) + 1);
  for (size_t i = 0; i < runs.size(); ++i) {
    const size_t region = At(runs[i].region);
    AddRun(sums[i], (runs[i].v - camera.cy) / camera.fy, runs[i].length(), &graph->moments[region]);
    graph->normals[region] += Eigen::Vector3d(sums[i].nx, sums[i].ny, sums[i].nz);
    graph->pixels[region] += runs[i].length();
  }
  for (PlaneMoments& m : graph->moments) {
    m.aa.triangularView<Eigen::StrictlyLower>() = m.aa.transpose();
  }
}

/// Counts the linked pairs of pixels of every two regions.
class ContactCounts {
 public:
  void Add(int32_t a, int32_t b, int32_t pairs) {
    if (a > b) std::swap(a, b);
    const uint64_t key = static_cast<uint64_t>(a) << 32 | static_cast<uint32_t>(b);
    counts_[key] += pairs;
  }
  std::vector<Contact> Sorted() const {
    std::vector<Contact> contacts;
    for (const auto& [key, pairs] : counts_) {
      contacts.push_back({static_cast<int32_t>(key >> 32), static_cast<int32_t>(key), pairs});
    }
    std::sort(contacts.begin(), contacts.end(), [](const Contact& x, const Contact& y) {
      return std::pair(x.a, x.b) < std::pair(y.a, y.b);
    });
    return contacts;
  }

 private:
  tsl::robin_map<uint64_t, int32_t> counts_;
};

std::vector<Contact> FindContacts(const Image<uint8_t>& links, const RunTable& runs) {
  ContactCounts counts;
  for (int v = 0; v < runs.height(); ++v) {
    const auto row = runs.row(v);
    const uint8_t* link = links.row(v);
    for (size_t i = 0; i + 1 < row.size(); ++i) {
      // A gap between the runs, or a depth jump.
      if (row[i].end != row[i + 1].begin || !(link[row[i].end - 1] & kLinkRight)) continue;
      counts.Add(row[i].region, row[i + 1].region, 1);
    }
    if (v + 1 == runs.height()) break;
    ForOverlaps(row, runs.row(v + 1),
                [&](const Run& upper, const Run& lower, int32_t begin, int32_t end) {
                  if (upper.region == lower.region) return;
                  const auto pairs = std::count_if(link + begin, link + end,
                                                   [](uint8_t bits) { return bits & kLinkDown; });
                  if (pairs > 0)
                    counts.Add(upper.region, lower.region, static_cast<int32_t>(pairs));
                });
  }
  return counts.Sorted();
}

/// For each region the regions that it touches, ascending.
std::vector<std::vector<int32_t>> Neighbors(const RegionGraph& graph) {
  std::vector<std::vector<int32_t>> neighbors(graph.pixels.size());
  for (const Contact& contact : graph.contacts) {
    neighbors[At(contact.a)].push_back(contact.b);
    neighbors[At(contact.b)].push_back(contact.a);
  }
  for (auto& list : neighbors) std::sort(list.begin(), list.end());
  return neighbors;
}

/// Whether a region lies on a plane within the noise.
bool LiesOn(const Eigen::Vector3d& plane, const PlaneMoments& part, double max_sigmas) {
  const double variance = part.variance / part.count();
  const double limit = max_sigmas * max_sigmas * variance;
  const double mean = part.MeanError(plane);
  return mean * mean < 0.25 * limit && part.MeanSquaredError(plane) < limit;
}

/// A host with all regions that were joined to it.
struct JoinedRegion {
  int32_t pixels = 0;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< sum over the pixels
  int32_t border = 0;  ///< linked pairs of pixels with other hosts; only of small ones
  std::map<int32_t, int32_t> neighbors;  ///< the same per other host
};

std::vector<JoinedRegion> Summarize(const RegionGraph& graph, const std::vector<int32_t>& hosts,
                                    int min_pixels) {
  std::vector<JoinedRegion> joined(hosts.size());
  for (size_t region = 1; region < hosts.size(); ++region) {
    JoinedRegion& host = joined[At(hosts[region])];
    host.pixels += graph.pixels[region];
    host.normal += graph.normals[region];
  }
  for (const Contact& contact : graph.contacts) {
    const int32_t a = hosts[At(contact.a)], b = hosts[At(contact.b)];
    if (a == b) continue;
    for (const auto& [one, other] : {std::pair(a, b), std::pair(b, a)}) {
      if (joined[At(one)].pixels >= min_pixels) continue;
      joined[At(one)].border += contact.pairs;
      joined[At(one)].neighbors[other] += contact.pairs;
    }
  }
  return joined;
}

/// The large region that a small one is joined to; 0 = none.
int32_t HostOf(const std::vector<JoinedRegion>& joined, const JoinedRegion& small, int min_pixels,
               double max_angle) {
  int32_t host = 0;
  int32_t most = small.border / 2;  // the host must share more than half of the border
  for (const auto& [neighbor, pairs] : small.neighbors) {
    if (pairs <= most || joined[At(neighbor)].pixels < min_pixels) continue;
    host = neighbor;
    most = pairs;
  }
  const Eigen::Vector3d& normal = joined[At(host)].normal;
  const double limit = std::cos(max_angle) * normal.norm() * small.normal.norm();
  return host != 0 && normal.dot(small.normal) >= limit ? host : 0;
}

}  // namespace

void PlaneMoments::Add(const PlaneMoments& other) {
  aa += other.aa;
  aw += other.aw;
  ww += other.ww;
  variance += other.variance;
}

Eigen::Vector3d PlaneMoments::Plane() const { return aa.ldlt().solve(aw); }

double PlaneMoments::MeanError(const Eigen::Vector3d& k) const {
  return (aw(2) - k.dot(aa.col(2))) / count();
}

double PlaneMoments::MeanSquaredError(const Eigen::Vector3d& k) const {
  return std::max(0.0, (ww - 2 * k.dot(aw) + k.dot(aa * k)) / count());
}

RegionGraph MakeRegionGraph(const SurfaceMap& surface, const PinholeCamera& camera,
                            const Image<uint8_t>& links, const Regions& regions) {
  const int width = links.width();
  RegionGraph graph{
      RunTable(width, links.height(),
               [&](int v, RunFlags flags) { MarkRegions(regions.image.row(v), width, flags); }),
      {},
      {},
      {},
      {}};
  for (Run& run : graph.runs.runs()) run.region = regions.image(run.v, run.begin);
  Measure(surface, camera, regions.count, &graph);
  graph.contacts = FindContacts(links, graph.runs);
  return graph;
}

std::vector<int32_t> JoinCoplanarRegions(const RegionGraph& graph, double max_sigmas) {
  const auto neighbors = Neighbors(graph);
  std::vector<PlaneMoments> moments = graph.moments;
  std::vector<int32_t> order(moments.size() - 1);
  std::iota(order.begin(), order.end(), 1);
  std::stable_sort(order.begin(), order.end(), [&](int32_t a, int32_t b) {
    return moments[At(a)].count() > moments[At(b)].count();
  });
  std::vector<int32_t> host(moments.size(), 0);
  for (const int32_t root : order) {
    PlaneMoments& whole = moments[At(root)];
    if (host[At(root)] != 0) continue;  // joined to a larger region before
    host[At(root)] = root;
    if (whole.count() < 3) continue;  // too few pixels for a plane
    Eigen::Vector3d plane = whole.Plane();
    if (whole.MeanSquaredError(plane) > max_sigmas * max_sigmas * whole.variance / whole.count()) {
      continue;  // the region itself is curved
    }
    std::vector<int32_t> open = neighbors[At(root)];
    for (size_t next = 0; next < open.size(); ++next) {  // `open` grows while it is read
      const size_t other = At(open[next]);
      if (host[other] != 0 || moments[other].count() == 0) continue;  // joined, or empty
      if (!LiesOn(plane, moments[other], max_sigmas)) continue;
      host[other] = root;
      whole.Add(moments[other]);
      plane = whole.Plane();
      open.insert(open.end(), neighbors[other].begin(), neighbors[other].end());
    }
  }
  return host;
}

std::vector<int32_t> JoinSmallRegions(const RegionGraph& graph, std::vector<int32_t> hosts,
                                      int min_pixels, double max_angle) {
  const std::vector<JoinedRegion> joined = Summarize(graph, hosts, min_pixels);
  std::vector<int32_t> becomes(hosts.size());
  for (size_t region = 1; region < joined.size(); ++region) {
    const JoinedRegion& one = joined[region];
    becomes[region] = one.pixels >= min_pixels ? static_cast<int32_t>(region)
                      : one.pixels > 0         ? HostOf(joined, one, min_pixels, max_angle)
                                               : 0;
  }
  for (int32_t& host : hosts) host = becomes[At(host)];
  return hosts;
}

std::vector<LooseRun> LooseRuns(const RegionGraph& graph, const std::vector<int32_t>& before,
                                const std::vector<int32_t>& after) {
  std::vector<LooseRun> loose;
  std::vector<int32_t> number(before.size(), -1);
  int32_t pieces = 0;
  for (const Run& run : graph.runs.runs()) {
    const int32_t host = before[At(run.region)];
    if (host == after[At(run.region)]) continue;
    if (number[At(host)] < 0) number[At(host)] = pieces++;
    loose.push_back({run.v, run.begin, run.end, number[At(host)]});
  }
  return loose;
}

SegmentImage PaintSegments(const RegionGraph& graph, const std::vector<int32_t>& hosts, int width) {
  const int height = graph.runs.height();
  SegmentImage image{Image<SegmentIndex>::Unset(width, height), 0};
  std::vector<SegmentIndex> index(hosts.size(), SegmentIndex::kNone);
  for (const Run& run : graph.runs.runs()) {
    const int32_t host = hosts[At(run.region)];
    if (host != 0 && index[At(host)] == SegmentIndex::kNone) {
      index[At(host)] = static_cast<SegmentIndex>(image.segment_count++);
    }
  }
  ParallelFor(At(height), kRunRowGrain, [&](size_t row) {
    const int v = static_cast<int>(row);
    SegmentIndex* pixels = image.index.row(v);
    std::fill_n(pixels, width, SegmentIndex::kNone);
    for (const Run& run : graph.runs.row(v)) {
      const int32_t host = hosts[At(run.region)];
      if (host != 0) std::fill(pixels + run.begin, pixels + run.end, index[At(host)]);
    }
  });
  return image;
}

}  // namespace vismap
