// Tools of several contacts and two hands, drawn: spheres in their pose, the force on
// each contact, the whole force and the torque, and where each hand is.
import * as three from "/vendor.min.js";
import { css, lay, rod } from "/shapes.js";

const kForceColours = ["force", "force2"];

// What lies inside a tool or the body is drawn over them.
function above(colour, opacity = 1) {
  return new three.MeshBasicMaterial({ color: css(colour), depthTest: false, transparent: true, opacity });
}

// An arrow of a vector; `heads` cones at its end: two stand for a torque.
class Arrow {
  constructor(thick, colour, heads = 1, opacity = 1) {
    this.colour = colour;
    this.thick = thick;
    this.material = above(colour, opacity);
    this.shaft = rod(thick, this.material);
    this.heads = Array.from({ length: heads }, () =>
      new three.Mesh(new three.ConeGeometry(2.6 * thick, 6 * thick, 24).translate(0, 3 * thick, 0), this.material));
    this.parts = [this.shaft, ...this.heads];
    for (const part of this.parts) {
      part.visible = false;
    }
  }

  show(from, along) {
    const end = from.clone().add(along);
    lay(this.shaft, from, end);
    const back = along.clone().normalize().multiplyScalar(-6 * this.thick);
    this.heads.forEach((head, i) => {
      head.visible = this.shaft.visible;
      head.quaternion.copy(this.shaft.quaternion);
      head.position.copy(end).addScaledVector(back, i);
    });
  }

  hide() { this.parts.forEach((part) => { part.visible = false; }); }
  recolour() { this.material.color.copy(css(this.colour)); }
}

const vector = (list) => new three.Vector3().fromArray(list);

// Spheres on thin rods to a hub, and a handle.
function toolGroup({ spheres }, handle, metal) {
  const group = new three.Group();
  const radius = Math.max(...spheres.map((sphere) => sphere.radius_m));
  const fine = spheres.length > 8 ? [20, 14] : [40, 28];
  const top = Math.max(...spheres.map((sphere) => sphere.centre_m[2] + sphere.radius_m));
  const hub = new three.Vector3(0, 0, spheres.length > 1 ? top + 0.6 * radius : 0);
  for (const { centre_m: centre, radius_m } of spheres) {
    const ball = new three.Mesh(new three.SphereGeometry(radius_m, ...fine), metal);
    ball.position.fromArray(centre);
    group.add(ball);
    if (spheres.length > 1) {
      const arm = rod(0.14 * radius, metal);
      lay(arm, ball.position.clone(), hub);
      group.add(arm);
    }
  }
  const shaft = rod(0.22 * radius, metal);
  lay(shaft, hub, new three.Vector3(0, 0, Math.max(handle, hub.z + radius)));
  group.add(shaft);
  return group;
}

export class ContactTools {
  // @param size [m] of the body, @param handle [m] of the tools.
  constructor(scene, tools, size, handle, metresPerNewton) {
    this.tools = tools;
    this.size = size;
    this.metresPerNewton = metresPerNewton;
    const lever = Math.max(...tools.flatMap(({ spheres }) => spheres.map(({ centre_m: c, radius_m }) => Math.hypot(...c) + radius_m)));
    this.metresPerNewtonMetre = (5 * metresPerNewton) / lever;
    const widest = Math.max(...tools.flatMap(({ spheres }) => spheres.map((sphere) => sphere.radius_m)));
    const thin = Math.min(0.012 * size, 0.25 * widest);
    const metal = new three.MeshStandardMaterial({ color: "#dfe6ea", roughness: 0.25, metalness: 0.1, transparent: true, opacity: 0.62 });
    const hand = (id) => ({
      group: toolGroup(tools[id], handle, metal),
      ball: new three.Mesh(new three.SphereGeometry(1.6 * thin, 24, 16), above("hand")),
      band: rod(0.4 * thin, above("hand")),
      cursor: new three.Mesh(new three.RingGeometry(2.2 * thin, 3 * thin, 32), above("hand")),
      contact: tools[id].spheres.map(() => new Arrow(0.34 * thin, kForceColours[id])),
      force: new Arrow(0.75 * thin, kForceColours[id]),
      other: new Arrow(0.3 * thin, "text", 1, 0.8),
      torque: new Arrow(0.6 * thin, "torque", 2),
    });
    this.hands = tools.map((_, i) => hand(i));
    this.hands.forEach((one) => {
      const flat = [one.cursor, one.band, one.ball, ...one.contact.flatMap((a) => a.parts), ...one.force.parts, ...one.torque.parts, ...one.other.parts];
      flat.forEach((mesh, order) => { mesh.renderOrder = 10 + order; });
      one.cursor.visible = one.ball.visible = one.band.visible = false;
      scene.add(one.group, ...flat);
    });
  }

  get arrows() { return this.hands.flatMap((one) => [...one.contact, one.force, one.other, one.torque]); }

  // All that moves, for telling whether the picture has changed.
  get moving() {
    return this.hands.flatMap((one) => [one.group, one.cursor, one.ball, one.band]).concat(this.arrows.map((arrow) => arrow.shaft));
  }

  // Which hand's tool a ray meets; -1: none.
  over(raycaster) {
    return this.hands.findIndex((one) => raycaster.intersectObject(one.group, true).length > 0);
  }

  showCursors(grip) {
    grip.hands.forEach(({ place }, i) => {
      const { cursor } = this.hands[i];
      cursor.visible = place !== null;
      if (place) {
        const normal = vector(place.normal);
        cursor.position.copy(vector(place.point)).addScaledVector(normal, 0.004 * this.size);
        cursor.quaternion.setFromUnitVectors(new three.Vector3(0, 0, 1), normal);
        cursor.material.opacity = grip.active.includes(grip.hands[i]) ? 1 : 0.35;
      }
    });
  }

  show(state) {
    const next = this.hands.map(() => 0);
    this.hands.forEach((one) => one.contact.forEach((arrow) => arrow.hide()));
    for (const touch of state.contacts) {
      const arrow = this.hands[touch.hand].contact[next[touch.hand]++];
      if (this.tools[touch.hand].spheres.length > 1) {
        arrow.show(vector(touch.centre_m), vector(touch.force_n).multiplyScalar(this.metresPerNewton));
      }
    }
    this.hands.forEach((one, i) => this.showHand(one, state.hands[i], state.coupled));
  }

  showHand(one, hand, coupled) {
    const at = vector(hand.tool_m);
    one.group.position.copy(at);
    one.group.quaternion.fromArray(hand.turn);
    one.ball.visible = hand.holding;
    one.ball.position.fromArray(hand.hand_m);
    lay(one.band, at, one.ball.position.clone());
    one.band.visible &&= hand.holding;
    const force = vector(hand.force_n).multiplyScalar(this.metresPerNewton);
    one.force.show(at, force);
    const other = vector(coupled ? hand.added_up_n : hand.coupled_n).multiplyScalar(this.metresPerNewton);
    one.other.show(at, other);
    one.torque.show(at, vector(hand.torque_n_m).multiplyScalar(this.metresPerNewtonMetre));
  }

  recolour() {
    this.arrows.forEach((arrow) => arrow.recolour());
    this.hands.forEach((one) => [one.ball, one.band, one.cursor].forEach((mesh) => mesh.material.color.copy(css("hand"))));
  }
}
