#pragma once

#include "simulation/builder.h"

// Furniture and objects of rooms and offices. Each stands at z = 0 of its place, centred on it.
// Sizes in m. "Faces x" means that its front is towards +x of the place.

namespace vismap {

SceneObject Chair(const SceneObject& object, const Place& place);  ///< four legs; faces x
SceneObject Table(const SceneObject& object, const Place& place);  ///< 1.2 x 0.8, 0.76 high
SceneObject Couch(const SceneObject& object, const Place& place);  ///< 1.8 x 0.8; faces y
SceneObject Television(const SceneObject& object, const Place& place);
SceneObject PottedPlant(const SceneObject& object, const Place& place, double size = 1);
SceneObject Lamp(const SceneObject& object, const Place& place);  ///< 1.7 high
SceneObject Backpack(const SceneObject& object, const Place& place);
SceneObject Cup(const SceneObject& object, const Place& place);
SceneObject Book(const SceneObject& object, const Place& place);
SceneObject Bottle(const SceneObject& object, const Place& place);
SceneObject Bowl(const SceneObject& object, const Place& place);
SceneObject Vase(const SceneObject& object, const Place& place);

/// A block with edge lengths `size`, for boxes, cabinets, machines, panels and boards.
SceneObject Block(const SceneObject& object, const Place& place, const Eigen::Vector3d& size);
/// An upright cylinder, for bins and stools.
SceneObject Drum(const SceneObject& object, const Place& place, double radius, double height);

SceneObject Desk(const SceneObject& object, const Place& place);         ///< 1.6 x 0.8, 0.74 high
SceneObject OfficeChair(const SceneObject& object, const Place& place);  ///< faces x
SceneObject Monitor(const SceneObject& object, const Place& place);      ///< screen towards -y
SceneObject Laptop(const SceneObject& object, const Place& place);       ///< screen towards -y
SceneObject DeskLamp(const SceneObject& object, const Place& place);

}  // namespace vismap
