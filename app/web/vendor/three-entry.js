export {
  AmbientLight, BufferAttribute, BufferGeometry, CanvasTexture, Color, DirectionalLight, DoubleSide, Group, InstancedBufferAttribute,
  InstancedMesh, Line, LineBasicMaterial, LineSegments, Matrix3, Matrix4, Mesh, MeshBasicMaterial, MeshLambertMaterial, Object3D,
  OrthographicCamera, PerspectiveCamera, PlaneGeometry, Points, PointsMaterial, Quaternion, Raycaster, Scene, ShaderMaterial, SphereGeometry,
  Sprite, SpriteMaterial, SRGBColorSpace, Vector2, Vector3, WebGLRenderer, Box3, ConeGeometry, CylinderGeometry, BoxGeometry, GridHelper, AxesHelper, NearestFilter, LinearFilter, Sphere, Plane, Ray, FrontSide, Fog
} from "three";
export { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
