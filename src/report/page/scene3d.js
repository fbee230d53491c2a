// The mesh in three.js: one triangle one colour, drawn only when something has changed.
import {
  AmbientLight,
  BufferAttribute,
  BufferGeometry,
  Color,
  DirectionalLight,
  DoubleSide,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshLambertMaterial,
  MeshBasicMaterial,
  PerspectiveCamera,
  Points,
  PointsMaterial,
  Raycaster,
  Scene,
  SphereGeometry,
  SRGBColorSpace,
  Vector2,
  Vector3,
  WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { styleColour } from './dom.js';

export class Scene3D {
  constructor(canvas, run) {
    this.run = run;
    this.renderer = new WebGLRenderer({ canvas, antialias: true });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(35, 1, 0.01, 100);
    this.camera.up.set(...run.up);
    this.light = new DirectionalLight(0xffffff, 1.9);
    this.scene.add(new AmbientLight(0xffffff, 1.7), this.light);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener('change', () => this.draw());
    this.addCloth();
    this.addSurroundings();
    this.resetView();
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  addCloth() {
    const corners = 3 * this.run.triangleCount;
    this.smooth = new BufferGeometry(); // gives normals at the vertices
    this.smooth.setIndex(new BufferAttribute(this.run.corners, 1));
    this.smooth.setAttribute('position', new BufferAttribute(new Float32Array(3 * this.run.vertices), 3));
    this.geometry = new BufferGeometry();
    for (const name of ['position', 'normal', 'color'])
      this.geometry.setAttribute(name, new BufferAttribute(new Float32Array(3 * corners), 3));
    this.cloth = new Mesh(
      this.geometry,
      new MeshLambertMaterial({
        vertexColors: true,
        side: DoubleSide,
        polygonOffset: true,
        polygonOffsetFactor: 1,
        polygonOffsetUnits: 1,
      }),
    );
    this.cloth.frustumCulled = false;

    const edges = new Map();
    const { corners: c } = this.run;
    for (let i = 0; i < c.length; i += 3) {
      for (const [a, b] of [
        [c[i], c[i + 1]],
        [c[i + 1], c[i + 2]],
        [c[i + 2], c[i]],
      ])
        edges.set(a < b ? a * this.run.vertices + b : b * this.run.vertices + a, [a, b]);
    }
    const wires = new BufferGeometry();
    wires.setAttribute('position', this.smooth.getAttribute('position'));
    wires.setIndex(new BufferAttribute(Uint32Array.from([...edges.values()].flat()), 1));
    this.edges = new LineSegments(wires, new LineBasicMaterial({ color: 0x20242c, transparent: true, opacity: 0.35 }));
    this.edges.visible = this.run.triangleCount <= 4000;
    this.edges.frustumCulled = false;

    this.highlight = new Mesh(
      new BufferGeometry(),
      new MeshBasicMaterial({ color: 0x00c2ff, side: DoubleSide, depthTest: false, transparent: true, opacity: 0.9 }),
    );
    this.highlight.frustumCulled = false;
    this.highlight.renderOrder = 2;
    this.scene.add(this.cloth, this.edges, this.highlight);
  }

  addSurroundings() {
    this.spheres = this.run.spheres.map(
      ({ radius }) =>
        new Mesh(new SphereGeometry(radius * 0.995, 48, 32), new MeshLambertMaterial({ color: 0x9aa5b4 })),
    );
    const pins = new BufferGeometry();
    pins.setAttribute('position', new BufferAttribute(new Float32Array(3 * this.run.pins.length), 3));
    this.pins = new Points(pins, new PointsMaterial({ color: 0x00a06a, size: 7, sizeAttenuation: false }));
    this.pins.frustumCulled = false;
    this.scene.add(...this.spheres, this.pins);
  }

  showFrame(frame) {
    this.frame = frame;
    const at = this.run.positions(frame),
      smooth = this.smooth.getAttribute('position');
    smooth.array.set(at);
    smooth.needsUpdate = true;
    this.smooth.computeVertexNormals();
    const normals = this.smooth.getAttribute('normal').array;
    const position = this.geometry.getAttribute('position'),
      normal = this.geometry.getAttribute('normal');
    this.run.corners.forEach((vertex, i) => {
      for (let axis = 0; axis < 3; ++axis) {
        position.array[3 * i + axis] = at[3 * vertex + axis];
        normal.array[3 * i + axis] = normals[3 * vertex + axis];
      }
    });
    position.needsUpdate = normal.needsUpdate = true;
    const pins = this.pins.geometry.getAttribute('position');
    this.run.pins.forEach((vertex, i) => pins.array.set(at.subarray(3 * vertex, 3 * vertex + 3), 3 * i));
    pins.needsUpdate = true;
    this.spheres.forEach((sphere, i) => sphere.position.set(...this.run.spheres[i].centers[frame]));
    if (this.marked) this.mark(this.marked);
  }

  /** `colourOf(triangle)`: red, green and blue from 0 to 255. */
  paint(colourOf) {
    const color = this.geometry.getAttribute('color'),
      made = new Color();
    for (let triangle = 0; triangle < this.run.triangleCount; ++triangle) {
      const [red, green, blue] = colourOf(triangle);
      made.setRGB(red / 255, green / 255, blue / 255, SRGBColorSpace);
      for (let corner = 0; corner < 3; ++corner) made.toArray(color.array, 9 * triangle + 3 * corner);
    }
    color.needsUpdate = true;
  }

  /** Highlights triangles in the frame that is shown; none for an empty list. */
  mark(triangles) {
    this.marked = triangles;
    const position = this.geometry.getAttribute('position').array;
    const made = Float32Array.from(
      triangles.flatMap((triangle) => [...position.subarray(9 * triangle, 9 * triangle + 9)]),
    );
    this.highlight.geometry.dispose();
    this.highlight.geometry = new BufferGeometry().setAttribute('position', new BufferAttribute(made, 3));
  }

  /** Moves the camera to the highlighted triangles, so that they fill about a tenth of the view. */
  lookAtMarked() {
    this.highlight.geometry.computeBoundingSphere();
    const { center, radius } = this.highlight.geometry.boundingSphere;
    const back = new Vector3()
      .subVectors(this.camera.position, this.controls.target)
      .setLength(Math.max(16 * radius, 0.15 * this.size));
    this.controls.target.copy(center);
    this.camera.position.addVectors(center, back);
    this.controls.update();
    this.draw();
  }

  resetView() {
    const { low, high } = this.run.box;
    const a = new Vector3(...low),
      b = new Vector3(...high);
    for (const { centers, radius } of this.run.spheres) {
      a.min(new Vector3(...centers[0]).subScalar(radius));
      b.max(new Vector3(...centers[0]).addScalar(radius));
    }
    this.size = a.distanceTo(b) || 1;
    this.controls.target.addVectors(a, b).multiplyScalar(0.5);
    this.camera.near = this.size / 500;
    this.camera.far = this.size * 20;
    this.camera.position
      .copy(this.controls.target)
      .addScaledVector(new Vector3(...this.run.view).normalize(), 1.7 * this.size);
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.draw();
  }

  /** Turns the camera about its target, radians; `zoom` multiplies its distance. */
  turn(sideways, upwards, zoom = 1) {
    const up = this.camera.up.clone().normalize(),
      offset = new Vector3().subVectors(this.camera.position, this.controls.target);
    offset.applyAxisAngle(up, sideways);
    const side = new Vector3().crossVectors(up, offset).normalize();
    const tilted = offset.clone().applyAxisAngle(side, upwards);
    if (tilted.angleTo(up) > 0.05 && tilted.angleTo(up) < Math.PI - 0.05) offset.copy(tilted);
    this.camera.position.addVectors(this.controls.target, offset.multiplyScalar(zoom));
    this.controls.update();
    this.draw();
  }

  /** The triangle at a place of the canvas in CSS pixels, or -1. */
  pick(x, y) {
    const { clientWidth, clientHeight } = this.renderer.domElement;
    const caster = new Raycaster();
    caster.setFromCamera(new Vector2((2 * x) / clientWidth - 1, 1 - (2 * y) / clientHeight), this.camera);
    this.geometry.computeBoundingSphere();
    return caster.intersectObject(this.cloth)[0]?.faceIndex ?? -1;
  }

  draw() {
    const canvas = this.renderer.domElement,
      { clientWidth: width, clientHeight: height } = canvas;
    if (width === 0 || height === 0) return;
    const ratio = this.renderer.getPixelRatio();
    if (canvas.width !== Math.floor(width * ratio) || canvas.height !== Math.floor(height * ratio)) {
      this.renderer.setSize(width, height, false);
      this.camera.aspect = width / height;
      this.camera.updateProjectionMatrix();
    }
    this.scene.background = new Color(styleColour('sky'));
    this.light.position
      .copy(this.camera.position)
      .add(new Vector3().setFromMatrixColumn(this.camera.matrix, 1).multiplyScalar(0.6 * this.size));
    this.renderer.render(this.scene, this.camera);
  }
}
