#include "simulation/office_stock.h"

#include <array>

#include "simulation/models.h"

namespace vismap {
namespace {

constexpr double kDesk = 0.74, kTable = 0.76;  // heights of the tops [m]

}  // namespace

// The colour, darkened a little at random.
Rgb8 OfficeStock::Tint(Rgb8 color) {
  const auto shift = [this](uint8_t x) {
    return static_cast<uint8_t>(x * dice_.Between(0.75, 1) + 0.5);
  };
  const uint8_t r = shift(color.r), g = shift(color.g), b = shift(color.b);
  return {r, g, b};
}

void OfficeStock::Workplace(const Place& place) {
  office_->Put(Desk(office_->Unknown("desk", Tint({205, 180, 140})), place));
  constexpr std::array<Heading, 3> kTurns{{kLeft, {-0.28, 0.96}, {0.28, 0.96}}};
  OfficeChair(place.At({dice_.Between(-0.15, 0.15), -0.78, 0}, kTurns[dice_.Of(3)]));
  OnDesk(place.At({0, 0, kDesk}));
  if (dice_.Chance(0.4)) Bin(place.At({-0.5, 0.15, 0}));
  if (dice_.Chance(0.25)) Backpack(place.At({0.45, 0.1, 0}));
}

void OfficeStock::OnDesk(const Place& place) {
  const bool monitor = dice_.Chance(0.8);
  if (monitor) {
    office_->Put(Monitor(office_->Known("tv", 72, Tint({40, 40, 48})), place.At({0, 0.22, 0})));
    Block(office_->Known("keyboard", 76, Tint({60, 60, 66})), place.At({0, -0.12, 0}),
          {0.44, 0.15, 0.03});
  } else {
    Laptop(place.At({0, 0, 0}));
  }
  if (dice_.Chance(0.4)) Cup(place.At({-0.37, dice_.Between(-0.2, 0.2), 0}));
  if (dice_.Chance(0.35)) Bottle(place.At({0.4, dice_.Between(-0.2, 0.2), 0}));
  if (dice_.Chance(0.45)) {
    const Place book = place.At({-0.64, dice_.Between(-0.15, 0.15), 0}, kMuch);
    Book(book);
    if (dice_.Chance(0.4)) Book(book.At({0, 0, 0.05}, kLittleRight));
  }
  if (dice_.Chance(0.3)) {
    const Rgb8 color = Tint({235, 205, 130});
    office_->Put(DeskLamp(office_->Unknown("lamp", color), place.At({0.65, 0.25, 0})));
  }
}

void OfficeStock::WorkplacesForFour(const Place& place) {
  for (const double x : {-0.81, 0.81}) {
    Workplace(place.At({x, -0.44, 0}));
    Workplace(place.At({x, 0.44, 0}, kBack));
  }
  if (dice_.Chance(0.7)) {
    Block(office_->Unknown("panel", Tint({120, 150, 170})), place, {3.22, 0.05, 1.1});
  }
}

void OfficeStock::TableForTwo(const Place& place) {
  office_->Put(Table(office_->Known("dining table", 67, Tint({190, 150, 105})), place));
  Chair(place.At({-0.85, 0, 0}));
  Chair(place.At({0.85, 0, 0}, kBack));
  if (dice_.Chance(0.6)) Cup(place.At({-0.2, 0.1, kTable}));
  if (dice_.Chance(0.6)) Bottle(place.At({0.15, -0.1, kTable}));
  if (dice_.Chance(0.4)) Book(place.At({0.3, 0.2, kTable}, kLittle));
}

void OfficeStock::OfficeChair(const Place& place) {
  office_->Put(vismap::OfficeChair(office_->Known("chair", 62, Tint({70, 85, 120})), place));
}
void OfficeStock::Chair(const Place& place) {
  office_->Put(vismap::Chair(office_->Known("chair", 62, Tint({150, 110, 75})), place));
}
void OfficeStock::Couch(const Place& place) {
  office_->Put(vismap::Couch(office_->Known("couch", 63, Tint({150, 75, 70})), place));
}
void OfficeStock::Plant(const Place& place) {
  const SceneObject plant = office_->Known("potted plant", 64, Tint({60, 140, 60}));
  office_->Put(PottedPlant(plant, place, dice_.Between(0.75, 1)));
}
void OfficeStock::Lamp(const Place& place) {
  office_->Put(vismap::Lamp(office_->Unknown("lamp", Tint({235, 205, 130})), place));
}
void OfficeStock::Cup(const Place& place) {
  office_->Put(vismap::Cup(office_->Known("cup", 47, Tint({235, 235, 240})), place));
}
void OfficeStock::Bottle(const Place& place) {
  office_->Put(vismap::Bottle(office_->Known("bottle", 44, Tint({50, 130, 90})), place));
}
void OfficeStock::Book(const Place& place) {
  constexpr std::array<Rgb8, 3> kCovers{{{180, 50, 55}, {50, 80, 170}, {200, 160, 60}}};
  office_->Put(vismap::Book(office_->Known("book", 84, kCovers[dice_.Of(3)]), place));
}
void OfficeStock::Laptop(const Place& place) {
  office_->Put(vismap::Laptop(office_->Known("laptop", 73, Tint({150, 150, 158})), place));
}
void OfficeStock::Television(const Place& place) {
  office_->Put(vismap::Television(office_->Known("tv", 72, Tint({40, 40, 48})), place));
}
void OfficeStock::Backpack(const Place& place) {
  office_->Put(vismap::Backpack(office_->Known("backpack", 27, Tint({60, 80, 150})), place));
}
void OfficeStock::Bin(const Place& place) {
  office_->Put(Drum(office_->Unknown("bin", Tint({90, 95, 100})), place, 0.14, 0.34));
}

void OfficeStock::Boxes(const Place& place) {
  Block(office_->Unknown("box", Tint({190, 150, 105})), place, {0.36, 0.34, 0.32});
  if (!dice_.Chance(0.6)) return;
  Block(office_->Unknown("box", Tint({215, 180, 130})), place.At({0, 0, 0.32}, kLittle),
        {0.26, 0.24, 0.22});
}

void OfficeStock::Whiteboard(const Place& place) {
  Block(office_->Unknown("whiteboard", {240, 240, 245}), place.At({0, 0.02, 1.0}),
        {1.5, 0.04, 1.0});
}
void OfficeStock::Picture(const Place& place) {
  const Rgb8 color = Tint({170, 120, 150});
  Block(office_->Unknown("picture", color), place.At({0, 0.02, 1.2}), {0.7, 0.04, 0.5});
}
void OfficeStock::Clock(const Place& place) {
  Block(office_->Known("clock", 85, Tint({230, 230, 220})), place.At({0, 0.02, 1.7}),
        {0.34, 0.04, 0.34});
}

void OfficeStock::Cabinet(const Place& place, const Eigen::Vector3d& size) {
  Block(office_->Unknown("cabinet", Tint({215, 215, 205})), place, size);
  if (size.z() > 1.3) return;
  const Place top = place.At({0, 0, size.z()});
  switch (dice_.Of(4)) {
    case 0:
      return Block(office_->Unknown("printer", Tint({200, 200, 205})), top, {0.45, 0.36, 0.3});
    case 1:
      Book(top.At({-0.2, 0, 0}, kLittle));
      return Book(top.At({-0.2, 0, 0.05}));
    case 2:
      return office_->Put(Vase(office_->Known("vase", 86, Tint({140, 90, 170})), top));
    default:
      return;
  }
}

void OfficeStock::Block(SceneObject object, const Place& place, const Eigen::Vector3d& size) {
  office_->Put(vismap::Block(object, place, size));
}

}  // namespace vismap
