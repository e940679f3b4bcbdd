import numpy as np

from pipelines.povray import passes
from pipelines.povray.scene import Scene

from .scenes import BALL, CAMERA, HEAD, LAMP, SIZE, InFolder

Y, X = ((0.5 - (np.arange(n) + 0.5) / n) for n in (48, 64))
RAY = np.stack(np.broadcast_arrays(-X[None, :] * 4 / 3, Y[:, None], 1.5), -1)
RAY /= np.linalg.norm(RAY, axis=-1, keepdims=True)


def truth(origin=(0, 0, -5), rays=RAY):
    """Distance and normal of the ball and the wall of scenes.BALL."""
    b = (rays * np.array(origin)).sum(-1)
    inside = b * b - (np.dot(origin, origin) - 1)
    ball = np.where(inside > 0, -b - np.sqrt(np.maximum(inside, 0)), np.inf)
    wall = (2 - origin[2]) / rays[..., 2]
    distance = np.minimum(ball, wall)
    on_ball = ball < wall
    normals = np.where(on_ball[..., None], np.array(origin) + distance[..., None] * rays, [0, 0, -1.0])
    return distance, normals, on_ball


class Passes(InFolder):
    def look(self, text, camera=None, **options):
        with Scene(self.scene(text), SIZE, **options) as scene:
            choice = passes.choose_passes(scene, camera)
            return choice, {name: found.mean for name, found in passes.render_features(scene, choice, 1).items()}

    def decided(self, choice, name):
        return next(d for d in choice.decisions if d.name == name)

    def check_ball(self, found):
        distance, normals, on_ball = truth()
        # Pixels of the silhouette may belong to either object.
        inner = np.abs(np.gradient(distance)[0]) + np.abs(np.gradient(distance)[1]) < 0.3
        self.assertGreater(inner.mean(), 0.8)
        np.testing.assert_allclose(found["Denoising Normal"][inner], normals[inner], atol=0.01)
        np.testing.assert_allclose(found["Denoising Depth"][..., 0][inner], distance[inner], rtol=0.01)
        return on_ball & inner

    def test_ball_before_a_wall(self):
        # The passes do not depend on the working gamma of POV-Ray.
        for gamma in (1.0, 2.2):
            choice, found = self.look(HEAD % gamma + CAMERA + BALL + LAMP)
            self.assertAlmostEqual(choice.gamma, gamma, delta=0.02)
            self.assertIsNotNone(choice.depth.place)
            on_ball = self.check_ball(found)
            colour = np.array([0.8, 0.4, 0.2]) ** gamma
            np.testing.assert_allclose(
                found["Denoising Albedo"][on_ball], np.broadcast_to(colour, (on_ball.sum(), 3)), rtol=0.01
            )
            # The ball's shadow on the wall has ambient light alone, though the wall faces the lamp.
            shadow = found["Visibility"][..., 0] < 0.9
            self.assertGreater((shadow & ~truth()[2]).sum(), 20)
            self.assertGreater(found["Visibility"][on_ball].min(), 0.99)

    def test_fog_where_the_camera_is_not_found(self):
        self.scene(CAMERA, "camera.inc")
        choice, found = self.look(HEAD % 1 + '#include "camera.inc"\n' + BALL + LAMP)
        self.assertIsNone(choice.depth.place)
        self.check_ball(found)

    def test_a_named_camera_after_one_that_is_not_there(self):
        named = (
            CAMERA.replace("camera {", "#declare C = camera {")
            + "#if (0) camera { location <9,9,9> } #end camera { C }\n"
        )
        choice, found = self.look(HEAD % 1 + named + BALL + LAMP)
        self.assertIn("not at <9", self.decided(choice, "depth by lamp").reason)
        self.assertIn("-5.0", choice.depth.place)
        self.check_ball(found)

    def test_fog_for_mirrors_and_glass(self):
        glass = (
            BALL.replace("<0.8,0.4,0.2>", "rgbf 1")
            .replace("rgb rgbf", "rgbf")
            .replace("diffuse 0.6", "diffuse 0 reflection 0.9", 1)
        )
        choice, found = self.look(HEAD % 1 + CAMERA + glass + LAMP)
        self.assertIn("fog measures them", self.decided(choice, "depth by lamp").reason)
        distance, _, on_ball = truth()
        self.assertLess(np.abs(found["Denoising Depth"][..., 0] / distance - 1)[on_ball].mean(), 0.02)

    def test_a_wrong_place_is_noticed(self):
        choice, found = self.look(HEAD % 1 + CAMERA + BALL + LAMP, camera="3,1,-4")
        self.assertIn("not at <3,1,-4>", self.decided(choice, "depth by lamp").reason)
        self.check_ball(found)

    def test_a_camera_inside_of_a_solid_has_no_fog(self):
        room = BALL.replace("plane { -z, -2 hollow", "box { -10, <10,10,2>")
        self.scene(CAMERA, "camera.inc")
        elsewhere = '#include "camera.inc"\n'
        choice, found = self.look(HEAD % 1 + elsewhere + room + LAMP)
        self.assertFalse(self.decided(choice, "depth").run)
        self.assertNotIn("Denoising Depth", found)
        choice, found = self.look(HEAD % 1 + elsewhere + room + LAMP, camera="0,0,-5")
        self.assertIn("not checked", self.decided(choice, "depth").reason)
        self.check_ball(found)

    def test_only_passes_that_the_scene_needs(self):
        # A glowing wall of one colour: albedo, lamps and shadows show nothing.
        glow = "plane { -z, -2 hollow pigment { rgb 0.5 } finish { ambient 1 diffuse 0 } }\n"
        choice, found = self.look(HEAD % 1 + CAMERA + glow + LAMP)
        self.assertEqual(set(found), {"Denoising Depth"})
        # Added lamps do not light a light group: no normals, and no depth by a lamp.
        choice, found = self.look(HEAD % 1 + CAMERA + "light_group {" + LAMP + BALL + "global_lights off }\n")
        self.assertFalse(self.decided(choice, "normal").run)
        self.assertIsNone(choice.depth.place)
        self.assertIn("Visibility", found)
