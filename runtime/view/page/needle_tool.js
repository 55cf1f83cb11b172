// A needle and its channels in three dimensions, over the body: a tube along the axis,
// each layer in its colour, a rim where the tip went in, and the needle inside.
import * as three from "/vendor.min.js";
import { layerColour } from "/needle.js";
import { css, lay, rod } from "/shapes.js";
import { needleGeometries } from "/tool_shape.js";

export class NeedleTool {
  // @param size of the body [m].
  constructor(scene, text, size) {
    this.scene = scene;
    this.length = text.puncture.deepest_m + text.depth_max_m;  // to the hub
    this.radius = Math.max(text.puncture.mouth_m, 0.005 * size);
    this.tip = text.tool.radius_m;
    this.channels = [];
    this.inside = rod(0.7 * this.radius, new three.MeshBasicMaterial({ color: "#f4f8fa", depthTest: false, transparent: true }));
    this.inside.renderOrder = 6;
    this.inside.visible = false;
    scene.add(this.inside);
    this.metal = new three.MeshStandardMaterial({ color: "#eef3f6", roughness: 0.22, metalness: 0.35 });
    this.hub = new three.MeshStandardMaterial({ color: css("accent"), roughness: 0.4 });
  }

  // Of the tool, in its frame.
  meshes() {
    const [shaft, hub] = needleGeometries(this.radius, this.tip, this.length);
    return [...shaft.map((geometry) => new three.Mesh(geometry, this.metal)), ...hub.map((geometry) => new three.Mesh(geometry, this.hub))];
  }

  // Where a hand holds the needle, from the reference point, as the tool is turned.
  grip(turn) { return new three.Vector3(0, 0, this.length).applyQuaternion(turn); }

  makeChannel({ materials }) {
    const tubes = materials.map((material) => {
      const tube = rod(2.6 * this.radius, new three.MeshBasicMaterial({ color: css(layerColour(material)), transparent: true, opacity: 0.75, depthTest: false }));
      tube.renderOrder = 5;
      tube.userData.material = material;
      return tube;
    });
    const rim = new three.Mesh(new three.RingGeometry(2.6 * this.radius, 3.8 * this.radius, 32), new three.MeshBasicMaterial({
      color: css(layerColour(materials[0])), side: three.DoubleSide, depthTest: false, transparent: true }));
    rim.renderOrder = 8;
    this.scene.add(...tubes, rim);
    return { tubes, rim };
  }

  remove({ tubes, rim }) {
    for (const mesh of [...tubes, rim]) {
      this.scene.remove(mesh);
      mesh.geometry.dispose();
      mesh.material.dispose();
    }
  }

  // True if the picture has changed.
  show({ needle, depth_m: depth }) {
    const drawn = JSON.stringify([needle.in, depth.toPrecision(5), ...needle.channels.map(({ entry_m, depth_m }) => [entry_m, depth_m.toPrecision(5)])]);
    if (drawn === this.drawn) {
      return false;
    }
    this.drawn = drawn;
    while (this.channels.length > needle.channels.length) {
      this.remove(this.channels.pop());
    }
    needle.channels.forEach((channel, i) => {
      this.channels[i] ??= this.makeChannel(channel);
      this.place(this.channels[i], channel);
    });
    this.inside.visible = needle.in >= 0;
    if (this.inside.visible) {
      const { entry_m: entry, axis } = needle.channels[needle.in];
      const from = new three.Vector3().fromArray(entry);
      lay(this.inside, from, from.clone().addScaledVector(new three.Vector3().fromArray(axis), -depth));
    }
    return true;
  }

  place({ tubes, rim }, { entry_m: entry, axis, depth_m: depth, layers_m: begins }) {
    const from = new three.Vector3().fromArray(entry);
    const outward = new three.Vector3().fromArray(axis);
    const at = (s) => from.clone().addScaledVector(outward, -s);
    tubes.forEach((tube, k) => {
      lay(tube, at(Math.min(depth, begins[k])), at(Math.min(depth, begins[k + 1] ?? Infinity)));
    });
    rim.position.copy(from);
    rim.quaternion.setFromUnitVectors(new three.Vector3(0, 0, 1), outward);
  }

  recolour() {
    this.hub.color.copy(css("accent"));
    for (const tube of this.channels.flatMap(({ tubes }) => tubes)) {
      tube.material.color.copy(css(layerColour(tube.userData.material)));
    }
  }
}
