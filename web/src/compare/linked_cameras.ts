import type { Vec3 } from "../core/case";
import { minus } from "../core/dots";
import type { Viewer } from "../scene/viewer";

/** Two views that look the same way from the same distance, each at its own joint. */
export class LinkedCameras {
  private following = false;

  constructor(first: Viewer, firstCentre: Vec3, second: Viewer, secondCentre: Vec3) {
    const shift = minus(secondCentre, firstCentre);
    first.onCamera = () => this.follow(second, first, shift);
    second.onCamera = () => this.follow(first, second, minus([0, 0, 0], shift));
    this.follow(second, first, shift);
  }

  private follow(follower: Viewer, leader: Viewer, shift: Vec3): void {
    if (this.following) return;
    this.following = true;
    follower.lookLike(leader, shift);
    this.following = false;
  }
}
