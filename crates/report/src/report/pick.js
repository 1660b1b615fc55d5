// What lies under a place of the picture: a ray from the eye against the triangles.

/** Triangles to a box. Neighbours in the list are neighbours in space, so that a ray meets few boxes. */
const RUN = 64;

/** Least and greatest x, y, z of runs of triangles; `indices` are their corners, or none where these follow one another. */
function boxesOf(place, indices) {
  const count = indices ? indices.length : place.length / 3, boxes = new Float32Array(6 * Math.ceil(count / (3 * RUN)));
  for (let run = 0, start = 0; start < count; run++, start += 3 * RUN) {
    boxes.fill(Infinity, 6 * run, 6 * run + 3);
    boxes.fill(-Infinity, 6 * run + 3, 6 * run + 6);
    for (let i = start; i < Math.min(start + 3 * RUN, count); i++) {
      const at = 3 * (indices ? indices[i] : i);
      for (let k = 0; k < 3; k++) {
        boxes[6 * run + k] = Math.min(boxes[6 * run + k], place[at + k]);
        boxes[6 * run + 3 + k] = Math.max(boxes[6 * run + 3 + k], place[at + k]);
      }
    }
  }
  return boxes;
}

/** True when a ray meets a box before a distance. */
function meets(boxes, at, from, way, most) {
  let near = 0, end = most;
  for (let k = 0; k < 3; k++) {
    const slope = way[k] || 1e-30, a = (boxes[at + k] - from[k]) / slope, b = (boxes[at + 3 + k] - from[k]) / slope;
    near = Math.max(near, Math.min(a, b));
    end = Math.min(end, Math.max(a, b));
  }
  return near <= end;
}

/** Distance along a ray to a triangle with the shares of its second and third corner, or nothing. */
function crossing(place, corners, from, way) {
  const [a, b, c] = corners.map(i => [place[3 * i], place[3 * i + 1], place[3 * i + 2]]);
  const one = b.map((v, k) => v - a[k]), two = c.map((v, k) => v - a[k]), off = from.map((v, k) => v - a[k]);
  const p = cross(way, two), size = dot(one, p), q = cross(off, one);
  const u = dot(off, p) / size, v = dot(way, q) / size;
  return u >= 0 && v >= 0 && u + v <= 1 ? { along: dot(two, q) / size, u, v } : null;
}

/** The first crossing of a ray with a body that the view shows, nearer than `most`. */
function firstCrossing({ place, indices, boxes }, from, way, seen, most) {
  let best = null;
  const count = indices ? indices.length : place.length / 3;
  for (let run = 0; 6 * run < boxes.length; run++) {
    if (!meets(boxes, 6 * run, from, way, best ? best.along : most)) continue;
    for (let i = 3 * RUN * run; i < Math.min(3 * RUN * (run + 1), count); i += 3) {
      const corners = indices ? [indices[i], indices[i + 1], indices[i + 2]] : [i, i + 1, i + 2];
      const found = crossing(place, corners, from, way);
      if (found && found.along < (best ? best.along : most) && seen(found.along)) best = { ...found, corners };
    }
  }
  return best;
}

/** Places, corners and boxes of a mesh, made when they are first asked for. */
function solid(mesh) {
  if (mesh.boxes) return mesh;
  if (!mesh.place) {
    const { low, size } = mesh.frame;
    mesh.place = Float32Array.from(mesh.positions, (v, i) => low[i % 3] + v / 65535 * size[i % 3]);
  }
  mesh.boxes = boxesOf(mesh.place, mesh.indices);
  return mesh;
}

/** Ray through a place of the picture (pixels), and whether a distance on it is in sight: beyond the near plane, inside of the section. */
function rayAt(x, y) {
  const { eye, near, plane } = projection(), { back, right, up } = frameOf(camera);
  const aspect = frames.size[0] / frames.size[1], wide = aspect < 1 ? FIELD / aspect : FIELD;
  const across = (2 * x / canvas.clientWidth - 1) * wide * aspect, upward = (1 - 2 * y / canvas.clientHeight) * wide;
  // Along the ray the distance is that from the plane of the eye.
  const way = back.map((b, k) => across * right[k] + upward * up[k] - b);
  const inside = along => !show.section || dot(plane, eye.map((e, k) => e + along * way[k])) <= plane[3];
  return { eye, way, seen: along => along >= near && inside(along) };
}

/** The first crossing with the part, nearer than `most`, with its sector. */
function partAt({ eye, way, seen }, most) {
  let best = null;
  const body = solid(part);
  scene.sectors.forEach(({ turn: [c, s] }, sector) => {
    const into = p => [p[0] * c + p[1] * s, p[1] * c - p[0] * s, p[2]];
    const found = firstCrossing(body, into(eye), into(way), seen, best ? best.along : most);
    if (found) best = { ...found, sector };
  });
  return best;
}

/** Surface, sector and deviation in um at a place of the picture; a code in the place of the deviation where there is none. */
function surfaceAt(x, y) {
  if (!scene || !part.indices || bodyNow() !== 'part') return null;
  const found = partAt(rayAt(x, y), Infinity);
  if (!found) return null;
  const { corners, sector, u, v } = found, shares = [1 - u - v, u, v];
  const codes = corners.map(i => part.deviations[sector * part.count + i]);
  const share = code => shares.reduce((sum, w, k) => sum + (codes[k] === code ? w : 0), 0);
  const without = share(NOT_REACHED) > 0.02 ? NOT_REACHED : share(NOT_MILLED) > 0.5 ? NOT_MILLED : null;
  const deviation = shares.reduce((sum, w, k) => sum + (codes[k] === NOT_REACHED || codes[k] === NOT_MILLED ? 0 : w * decode(codes[k])), 0);
  return { surface: part.surface[corners[0]], sector, without, deviation };
}

/** The point at a place of the picture on whatever body there is. */
function pointAt(x, y) {
  if (!scene || !part.indices) return null;
  const ray = rayAt(x, y), body = bodyNow();
  let along = body === 'part' ? partAt(ray, Infinity)?.along ?? Infinity : Infinity;
  const mesh = meshOf(body === 'part' ? 'turned' : body);
  if (mesh) along = firstCrossing(solid(mesh), ray.eye, ray.way, ray.seen, along)?.along ?? along;
  return along < Infinity ? ray.eye.map((e, k) => e + along * ray.way[k]) : null;
}
