#include "files/svg_picture.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>

#include "files/atomic_file.h"
#include "files/surface_check.h"
#include "files/xml.h"

namespace taut {
namespace {

// Sizes in the picture's own units (pixels at its natural size).
constexpr double margin = 36, title_height = 44, legend_width = 150, scene_width = 760, bar_width = 16,
                 bar_height = 240;
constexpr double least_height = 380, largest_height = 820;

/// "magma" of matplotlib (CC0), from light to dark and without its two darkest ninths: perceptually uniform, readable
/// without colour vision and in print. Slack cloth is light, so that its folds show, and what is taut stands out.
constexpr std::array<std::array<double, 3>, 8> colours{{{252, 253, 191},
                                                        {254, 201, 141},
                                                        {253, 149, 103},
                                                        {241, 96, 93},
                                                        {205, 64, 113},
                                                        {159, 47, 127},
                                                        {114, 31, 129},
                                                        {69, 16, 119}}};

Vector3 colour_at(double fraction) {
  const double place = std::clamp(fraction, 0.0, 1.0) * (colours.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(place), colours.size() - 2);
  const double part = place - static_cast<double>(below);
  return (1 - part) * Vector3(colours[below].data()) + part * Vector3(colours[below + 1].data());
}

std::string hex(const Vector3& colour) {
  const auto byte = [&](int i) { return static_cast<int>(std::lround(std::clamp(colour[i], 0.0, 255.0))); };
  return fmt::format("#{:02x}{:02x}{:02x}", byte(0), byte(1), byte(2));
}

/// Orthonormal; a point's picture coordinates are its products with `right` and `up`, its nearness that with `toward`.
struct Camera {
  Vector3 right, up, toward;
};

Camera camera_of(const Picture& picture) {
  const Vector3 sky = picture.up.norm() > 0 ? Vector3(picture.up.normalized()) : Vector3::UnitZ();
  Vector3 toward = picture.view_from;
  if (toward.norm() == 0) {
    const Vector3 sideways = std::abs(sky.x()) < 0.9 ? Vector3::UnitX() : Vector3::UnitY();
    const Vector3 right = (sideways - sideways.dot(sky) * sky).normalized();
    toward = 0.5 * right + right.cross(sky) + 0.5 * sky;
  }
  toward.normalize();
  Vector3 right = sky.cross(toward);
  // Looking straight along the sky direction, any axis may point right.
  if (right.norm() < 1e-6) right = toward.unitOrthogonal();
  right.normalize();
  return {right, toward.cross(right), toward};
}

/// Where the scene's coordinates go on the page.
struct Page {
  Camera camera;
  double scale = 1, left = 0, top = 0;
  double scene_height = least_height;

  double x(const Vector3& point) const { return left + scale * camera.right.dot(point); }
  double y(const Vector3& point) const { return top - scale * camera.up.dot(point); }
  double width() const { return margin + scene_width + legend_width + margin; }
  double height() const { return title_height + scene_height + 2 * margin; }
};

Page fitted_page(const Picture& picture) {
  Page page{camera_of(picture)};
  Eigen::AlignedBox<double, 2> box;
  const auto cover = [&](const Vector3& point, double radius) {
    const Vector2 seen(page.camera.right.dot(point), page.camera.up.dot(point));
    box.extend(Vector2(seen.array() - radius)).extend(Vector2(seen.array() + radius));
  };
  for (Index i = 0; i < picture.positions.size(); i += 3) cover(picture.positions.segment<3>(i), 0);
  for (const auto& sphere : picture.spheres) cover(sphere.center, sphere.radius);
  if (box.isEmpty()) return page;

  const double extent = box.sizes().maxCoeff();
  const Vector2 size = box.sizes().cwiseMax(extent > 0 ? 1e-9 * extent : 1.0);
  page.scene_height = std::clamp(scene_width * size.y() / size.x(), least_height, largest_height);
  page.scale = std::min(scene_width / size.x(), page.scene_height / size.y());
  page.left = margin + scene_width / 2 - page.scale * box.center().x();
  page.top = margin + title_height + page.scene_height / 2 + page.scale * box.center().y();
  return page;
}

/// Area-weighted unit normals at the vertices: they shade a folded surface without the pattern of its diagonals.
std::vector<Vector3> vertex_normals(const Vector& positions, const std::vector<Triangle>& triangles) {
  std::vector<Vector3> normals(static_cast<std::size_t>(positions.size() / 3), Vector3::Zero());
  for (const auto& [a, b, c] : triangles) {
    const Vector3 origin = positions.segment<3>(3 * a);
    const Vector3 normal = (positions.segment<3>(3 * b) - origin).cross(positions.segment<3>(3 * c) - origin);
    for (const int vertex : {a, b, c}) normals[vertex] += normal;
  }
  for (Vector3& normal : normals) normal.normalize();
  return normals;
}

/// Lambert's cosine law for both sides of the cloth, from a lamp above the eye's left shoulder. Shadows are mild, so
/// that the colours stay readable, and violet, because yellow times grey is mud.
Vector3 shaded(const Vector3& colour, const Vector3& normal, const Camera& camera) {
  const Vector3 shadow(0.62, 0.54, 0.66);
  const Vector3 lamp = (camera.toward - 0.6 * camera.right + 0.7 * camera.up).normalized();
  const double length = normal.norm();
  const double light = length > 0 ? std::min(1.0, 1.15 * std::abs(normal.dot(lamp)) / length) : 0.5;
  return colour.cwiseProduct((1 - light) * shadow + light * Vector3::Ones());
}

/// Appends a whole number of hundredths as a decimal without zeros at its end; several times as fast as a format.
void add_hundredths(double hundredths, std::string& text) {
  long long n = std::llround(hundredths);
  if (n < 0) text += '-';
  n = std::abs(n);
  const fmt::format_int whole(n / 100);
  text.append(whole.data(), whole.size());
  if (n % 100 == 0) return;
  text += '.';
  text += static_cast<char>('0' + n % 100 / 10);
  if (n % 10 != 0) text += static_cast<char>('0' + n % 10);
}

/// A piece of SVG and how near it is to the eye.
struct Shape {
  double nearness;
  std::string text;
};

void add_triangles(const Picture& picture, const Page& page, std::vector<Shape>& shapes) {
  const auto& triangles = *picture.triangles;
  const auto normals = vertex_normals(picture.positions, triangles);
  // Rounded once per vertex, so that neighbours share their edge exactly.
  const auto hundredths = [](double value) { return std::round(100 * value); };
  const double range = picture.high - picture.low;
  shapes.reserve(triangles.size() + picture.spheres.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    std::array<double, 3> x, y;
    Vector3 center = Vector3::Zero(), normal = Vector3::Zero();
    for (int i = 0; i < 3; ++i) {
      const Vector3 point = picture.positions.segment<3>(3 * triangles[t][i]);
      x[i] = hundredths(page.x(point));
      y[i] = hundredths(page.y(point));
      center += point / 3;
      normal += normals[triangles[t][i]];
    }
    const double value = picture.triangle_values[t];
    const Vector3 colour =
        std::isfinite(value) ? colour_at(range > 0 ? (value - picture.low) / range : 0.5) : Vector3{150, 150, 150};
    const std::string paint = hex(shaded(colour, normal, page.camera));
    Shape& shape = shapes.emplace_back(Shape{page.camera.toward.dot(center), "<path d=\"M"});
    const std::array<double, 6> numbers{x[0], y[0], x[1] - x[0], y[1] - y[0], x[2] - x[1], y[2] - y[1]};
    for (int i = 0; i < 6; ++i) {
      if (i > 0) shape.text += i == 2 ? 'l' : ' ';
      add_hundredths(numbers[i], shape.text);
    }
    shape.text.append("z\" fill=\"").append(paint).append("\" stroke=\"").append(paint).append("\"/>\n");
  }
}

/// Ordering a sphere by its centre is exact for cloth outside it: what is nearer than the centre is in front, what is
/// farther is hidden.
std::string drawn_scene(const Picture& picture, const Page& page) {
  std::vector<Shape> shapes;
  add_triangles(picture, page, shapes);
  for (const auto& [center, radius] : picture.spheres) {
    shapes.push_back({page.camera.toward.dot(center),
                      fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{:.2f}\" fill=\"url(#ball)\"/>\n",
                                  page.x(center), page.y(center), page.scale * radius)});
  }
  std::stable_sort(shapes.begin(), shapes.end(),
                   [](const Shape& a, const Shape& b) { return a.nearness < b.nearness; });

  std::string text = "<g stroke-width=\"1\" stroke-linejoin=\"round\">\n";
  for (const Shape& shape : shapes) text += shape.text;
  text += "</g>\n<g fill=\"#fff\" stroke=\"#1f2933\" stroke-width=\"1.6\">\n";
  for (const int vertex : picture.marked_vertices) {
    const Vector3 point = picture.positions.segment<3>(3 * vertex);
    text += fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"4\"/>\n", page.x(point), page.y(point));
  }
  return text + "</g>\n";
}

/// The numbers beside the colour scale, with as many decimals as tell them apart and none that is 0 in all of them.
std::vector<std::string> tick_labels(double low, double high, int count) {
  const double largest = std::max(std::abs(low), std::abs(high)), step = (high - low) / (count - 1);
  const bool plain = largest < 1e5 && largest >= 1e-3;
  int decimals = step > 0 ? std::clamp(static_cast<int>(std::ceil(-std::log10(step))) + 1, 0, 12) : 4;
  std::vector<std::string> labels;
  do {
    labels.clear();
    for (int i = 0; i < count; ++i) {
      const double value = low + step * i;
      labels.push_back(plain ? fmt::format("{:.{}f}", value, decimals) : fmt::format("{:.3g}", value));
    }
  } while (plain && decimals-- > 0 &&
           std::all_of(labels.begin(), labels.end(), [](const auto& label) { return label.back() == '0'; }));
  return labels;
}

std::string drawn_legend(const Picture& picture, const Page& page) {
  constexpr int ticks = 5;
  const double x = margin + scene_width + 28, top = title_height + margin + (page.scene_height - bar_height) / 2;
  std::string text = fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"13\">{}</text>\n", x, top - 16,
                                 xml_escaped(picture.value_name));
  text += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{}\" height=\"{}\" rx=\"3\" fill=\"url(#scale)\"/>\n", x,
                      top, bar_width, bar_height);
  const auto labels = tick_labels(picture.low, picture.high, ticks);
  for (int i = 0; i < ticks; ++i) {
    const double y = top + bar_height * (1 - static_cast<double>(i) / (ticks - 1));
    text += fmt::format("<path d=\"M{:.1f} {:.1f}h5\" stroke=\"#7b8794\"/>", x + bar_width + 2, y);
    text += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"13\">{}</text>\n", x + bar_width + 12, y + 4.5,
                        labels[i]);
  }
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const double value : picture.triangle_values) {
    if (std::isfinite(value)) least = std::min(least, value), most = std::max(most, value);
  }
  if (least <= most) {
    text +=
        fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"11\" fill=\"#7b8794\">here {:.5g} to {:.5g}</text>\n",
                    x, top + bar_height + 26, least, most);
  }
  return text;
}

std::string definitions() {
  std::string text =
      "<defs>\n<linearGradient id=\"sky\" x2=\"0\" y2=\"1\"><stop stop-color=\"#fdfdfe\"/>"
      "<stop offset=\"1\" stop-color=\"#e9edf2\"/></linearGradient>\n"
      "<radialGradient id=\"ball\" cx=\".36\" cy=\".3\" r=\".75\"><stop stop-color=\"#f4f6f8\"/>"
      "<stop offset=\".55\" stop-color=\"#c3cad3\"/><stop offset=\"1\" stop-color=\"#8a94a2\"/></radialGradient>\n"
      "<linearGradient id=\"scale\" x2=\"0\" y1=\"1\" y2=\"0\">";
  for (std::size_t i = 0; i < colours.size(); ++i) {
    const double fraction = static_cast<double>(i) / (colours.size() - 1);
    text += fmt::format("<stop offset=\"{:.4g}\" stop-color=\"{}\"/>", fraction, hex(colour_at(fraction)));
  }
  return text + "</linearGradient>\n</defs>\n";
}

void check(const Picture& picture) {
  if (!picture.triangles) throw std::invalid_argument("write_svg: triangles must not be null");
  check_surface("write_svg", picture.positions, *picture.triangles);
  if (!picture.positions.allFinite()) throw std::invalid_argument("write_svg: positions must be finite numbers");
  if (picture.triangle_values.size() != picture.triangles->size()) {
    throw std::invalid_argument(fmt::format("write_svg: triangle_values must hold {} values, got {}",
                                            picture.triangles->size(), picture.triangle_values.size()));
  }
  for (const int vertex : picture.marked_vertices) {
    if (vertex < 0 || vertex >= picture.positions.size() / 3) {
      throw std::invalid_argument(
          fmt::format("write_svg: marked_vertices names vertex {}, expected one of the {} vertices", vertex,
                      picture.positions.size() / 3));
    }
  }
}

}  // namespace

void write_svg(const std::filesystem::path& path, const Picture& picture) {
  check(picture);
  const Page page = fitted_page(picture);
  std::string text = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "font-family=\"Helvetica, Arial, sans-serif\" fill=\"#323f4b\">\n",
      page.width(), page.height());
  text += definitions();
  text += "<rect width=\"100%\" height=\"100%\" fill=\"url(#sky)\"/>\n";
  text += fmt::format(
      "<title>{0}</title>\n<text x=\"{1}\" y=\"{2}\" font-size=\"21\" font-weight=\"600\" "
      "fill=\"#1f2933\">{0}</text>\n",
      xml_escaped(picture.title), margin, margin + 12);
  text += drawn_scene(picture, page);
  text += drawn_legend(picture, page);
  write_atomically(path, text + "</svg>\n");
}

}  // namespace taut
