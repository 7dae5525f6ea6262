// SPDX-License-Identifier: Apache-2.0
namespace UnityEngine
{
    public sealed class Camera : Behaviour
    {
        private float _fieldOfView = 60F;

        /// <summary>Without a list: Unity's allocates nothing either.</summary>
        public static Camera main
        {
            get
            {
                foreach (Object any in Stage.Scene.Objects)
                {
                    var camera = any as Camera;
                    if (camera != null && camera.IsActive() && camera.tag == "MainCamera")
                    {
                        return camera;
                    }
                }
                return null;
            }
        }

        public RenderTexture targetTexture { get; set; }

        public bool orthographic { get; set; }

        public float orthographicSize { get; set; }

        public int pixelHeight
        {
            get { return targetTexture != null ? targetTexture.height : Screen.height; }
        }

        public float fieldOfView
        {
            get { return _fieldOfView; }
            set { _fieldOfView = value; }
        }

        public void Render()
        {
            Stage.MainThread.Check("Render");
            Stage.Gpu.Rendered++;
        }

        /// <summary>A ray through a pixel of a square screen with a side of Screen.height.</summary>
        public Ray ScreenPointToRay(Vector3 pos)
        {
            float reach = Mathf.Tan(fieldOfView * Mathf.Deg2Rad / 2F) * 2F / Screen.height;
            var direction = new Vector3((pos.x - Screen.width / 2F) * reach,
                (pos.y - Screen.height / 2F) * reach, 1F);
            return new Ray(transform.position, transform.TransformDirection(direction));
        }
    }

    public sealed class Screen
    {
        public static int width
        {
            get { return 1280; }
        }

        public static int height
        {
            get { return 720; }
        }
    }
}
