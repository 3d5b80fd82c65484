; THEOREM    00: the guard and the safe state, multiplied by 2b.
; ASSUMED    b > 0; SH.1 and SH.3 as they are printed, and as 01a, 02, 03d and 09 have them,
;            without a division.
; CONCLUDED  Each is true where the other is.
; SOURCE     spec/shield.md SH.1, SH.3.
; TWIN       in the multiplied form one factor 2 is left out.
; SOLVERS    z3
(set-info :status unsat)
(set-logic QF_NRA)

; Symbols
(declare-const b Real)        ; least braking, told to rest
(declare-const eps Real)      ; reaction time
(declare-const V Real)        ; greatest speed of the thing's class
(declare-const kappa Real)    ; closing cosine
(declare-const s Real)        ; robot's own way since the thing was seen
(declare-const age Real)      ; time since the thing was seen
(declare-const d Real)        ; clearance when the thing was seen
(declare-const w Real)        ; greatest speed until the robot begins to brake
(declare-const v Real)        ; speed of the robot
(declare-const r Real)        ; what is left of the clearance
; Formulas
(define-fun way_to_rest ((w Real)) Real (+ (* w eps) (/ (* w w) (* 2 b))))
(define-fun time_to_rest ((w Real)) Real (+ eps (/ w b)))
(define-fun need ((w Real)) Real
  (+ (* kappa (+ s (way_to_rest w))) (* V (+ age (time_to_rest w)))))
(define-fun safe_need ((v Real)) Real (+ (/ (* kappa v v) (* 2 b)) (/ (* V v) b)))
(define-fun fits ((w Real)) Bool
  (<= (+ (* kappa (+ (* 2 b s) (* 2 b w eps) (* w w))) (* 2 V (+ (* b age) (* b eps) w))) (* 2 b d)))
(define-fun safe ((v Real) (r Real)) Bool (<= (+ (* kappa v v) (* 2 V v)) (* 2 b r)))

; Assumptions
(assert (> b 0))
(assert (> eps 0))
(assert (>= V 0))
(assert (<= 0 kappa 1))
(assert (>= s 0))
(assert (>= age 0))
(assert (>= w 0))
(assert (>= v 0))

; Conclusion, negated
(assert (not (and (= (fits w) (<= (need w) d)) (= (safe v r) (<= (safe_need v) r)))))
(check-sat)
