// Pictures of cameras, where the site allows them: asked for only while they are shown.

import { useEffect, useState } from "preact/hooks";

/** Time from one picture to the next question; longer where none came [ms]. */
const [AGAIN_MS, LATER_MS] = [500, 1000];

async function picture(camera: string): Promise<Blob | null> {
  const path = `/api/cameras/${encodeURIComponent(camera)}/picture`;
  const response = await fetch(path, { credentials: "same-origin", cache: "no-store" });
  return response.ok ? response.blob() : null;
}

/** Return an address of the newest picture of a camera; "" while there is none. */
export function usePicture(camera: string, wanted: boolean): string {
  const [url, set] = useState("");
  useEffect(() => {
    if (!wanted) return undefined;
    let [ended, last, timer] = [false, "", 0];
    const next = async () => {
      const found = document.hidden ? null : await picture(camera).catch(() => null);
      if (ended) return;
      if (found) {
        URL.revokeObjectURL(last);
        last = URL.createObjectURL(found);
        set(last);
      }
      timer = window.setTimeout(() => void next(), found ? AGAIN_MS : LATER_MS);
    };
    void next();
    return () => {
      ended = true;
      clearTimeout(timer);
      URL.revokeObjectURL(last);
      set("");
    };
  }, [camera, wanted]);
  return url;
}
