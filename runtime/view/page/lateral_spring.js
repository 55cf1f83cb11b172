// The spring that holds a contact sideways, drawn: from its anchor, where the contact
// stuck, to its foot under the tool.
import * as three from "/vendor.min.js";
import { shareOfLimit } from "/friction.js";
import { css, lay, rod } from "/shapes.js";

export class LateralSpring {
  constructor(scene, thin) {
    this.material = new three.MeshBasicMaterial({ depthTest: false, transparent: true });
    this.line = rod(0.5 * thin, this.material);
    this.anchor = new three.Mesh(new three.SphereGeometry(0.9 * thin, 20, 14), this.material);
    this.foot = new three.Mesh(new three.SphereGeometry(0.6 * thin, 20, 14), this.material);
    this.parts = [this.line, this.anchor, this.foot];
    for (const mesh of this.parts) {
      mesh.renderOrder = 17;
      mesh.visible = false;
    }
    scene.add(...this.parts);
  }

  // Between the place that the tool's lowest point has and where that was.
  show({ friction, contact_m: point, normal, penetration_m: depth }) {
    const foot = new three.Vector3().fromArray(point).addScaledVector(new three.Vector3().fromArray(normal), -depth);
    const anchor = foot.clone().sub(new three.Vector3().fromArray(friction.stretch_m));
    lay(this.line, anchor, foot);
    this.anchor.visible = this.foot.visible = friction.state !== "free";
    this.line.visible &&= this.anchor.visible;
    this.anchor.position.copy(anchor);
    this.foot.position.copy(foot);
    // From what sticks over half the limit to what slips.
    const share = shareOfLimit(friction);
    const [from, to] = share < 0.5 ? ["accent", "hand"] : ["hand", "warn"];
    this.material.color.copy(css(from)).lerp(css(to), share < 0.5 ? 2 * share : 2 * share - 1);
  }
}
