; BROKEN     Twin of 08_speed_uncertainty.smt2: the guard is given the speed that was measured.
(set-info :status sat)
(set-logic QF_NRA)

; Symbols
(declare-const A Real)        ; greatest acceleration
(declare-const b Real)        ; least braking, told to rest
(declare-const eps Real)      ; reaction time
(declare-const V Real)        ; greatest speed of the thing's class
(declare-const kappa Real)    ; closing cosine
(declare-const s Real)        ; robot's own way since the thing was seen
(declare-const age Real)      ; time since the thing was seen
(declare-const d Real)        ; clearance when the thing was seen
(declare-const c Real)        ; commanded speed
(declare-const u Real)        ; bound of the robot's present speed
(declare-const v Real)        ; true speed
(declare-const vm Real)       ; measured speed
(declare-const Delta Real)    ; greatest error
(declare-const te Real)       ; when the command to rest takes effect
(declare-const xe Real)       ; way until then
(declare-const ve Real)       ; speed then
(declare-const tb Real)       ; time spent braking
(declare-const xb Real)       ; way while braking
(declare-const v2 Real)       ; speed after braking
; Formulas
(define-fun way_to_rest ((w Real)) Real (+ (* w eps) (/ (* w w) (* 2 b))))
(define-fun time_to_rest ((w Real)) Real (+ eps (/ w b)))
(define-fun need ((w Real)) Real
  (+ (* kappa (+ s (way_to_rest w))) (* V (+ age (time_to_rest w)))))
(define-fun fastest ((c Real) (u Real)) Real (ite (>= (+ c (* A eps)) u) (+ c (* A eps)) u))
(define-fun safe_need ((v Real)) Real (+ (/ (* kappa v v) (* 2 b)) (/ (* V v) b)))

; Assumptions
(assert (>= A 0))
(assert (> b 0))
(assert (> eps 0))
(assert (>= V 0))
(assert (<= 0 kappa 1))
(assert (>= s 0))
(assert (>= age 0))
(assert (>= c 0))
(assert (>= u 0))
(assert (>= v 0))
(assert (>= vm 0))
(assert (>= Delta 0))
(assert (>= te 0))
(assert (>= xe 0))
(assert (>= ve 0))
(assert (>= tb 0))
(assert (>= xb 0))
(assert (>= v2 0))
(assert (and (<= (- vm v) Delta) (<= (- v vm) Delta)))
(assert (= u vm))                                            ; BROKEN: the error is not added
(assert (<= (need (fastest c u)) d))
(assert (<= te eps))
(assert (<= xe (* (fastest c v) te)))             ; the model, with the true speed
(assert (<= ve (fastest c v)))
(assert (<= v2 ve))
(assert (<= (* b tb) (- ve v2)))
(assert (<= (* 2 b xb) (- (* ve ve) (* v2 v2))))

; Conclusion, negated
(assert (not (<= (safe_need v2) (- d (* kappa (+ s xe xb)) (* V (+ age te tb))))))
(check-sat)
